"""What both formats of assembly files say about parts by name, and what is wrong with it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from wiggleroom.drawing.assembly_schema import convert


class NameChecks:
    """Base of the readers of one file, which collect what is wrong with it."""

    _file: str
    _findings: list[str]
    _names: set[str]

    def _say(self, where: str, what: str) -> None:
        self._findings.append(f"{self._file}: {where}: {what}" if where else f"{self._file}: {what}")

    def _known(self, where: str, names: Iterable[str]) -> None:
        for name in names:
            if name not in self._names:
                self._say(where, f'there is no part "{name}"; it must be the name of a part')

    def _together(self, where: str, value: Any) -> tuple[str, ...]:
        names = convert(value, list[str], f"{self._file}: {where}", self._findings)
        if names is None:
            return ()
        self._known(where, names)
        if len(set(names)) < max(2, len(names)):
            self._say(where, "must name at least two different parts, each once")
        return tuple(names)

    def _pair(self, where: str, value: Any) -> tuple[str, str]:
        names = convert(value, tuple[str, str], f"{self._file}: {where}", self._findings)
        if names is None:
            return ("", "")
        self._known(where, names)
        if names[0] == names[1]:
            self._say(where, "must name two different parts")
        return names
