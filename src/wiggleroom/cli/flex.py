"""`wiggleroom flex`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Literal

from wiggleroom.cli.options import Asked, read
from wiggleroom.cli.outputs import PICTURES, Outputs, check, write

if TYPE_CHECKING:
    from wiggleroom.analysis.answer import Answer

_NONE_ASKED, _NO_OUTPUTS = Asked(), Outputs()


def flex(
    file: str,
    /,
    *,
    asked: Asked = _NONE_ASKED,
    outputs: Outputs = _NO_OUTPUTS,
    model: str = "walls",
    solver: Literal["interior-point", "ipopt"] = "interior-point",
) -> int:
    """Find the largest motion of the pulled parts.

    Parts are rigid and never overlap. The answer is a motion that was found and checked by exact geometry, with a
    verdict on how sure it is. Ctrl-C stops early and reports the best safe motion so far (exit 3).

    Example: wiggleroom flex puzzle.svg --gap 0.2 --fix p1 --pull p20:+x --picture moved.svg

    Parameters
    ----------
    file
        A drawing (.svg, .dxf) or an assembly file (.json).
    model
        How the free space of each pair is modelled: walls, the exact contacts.
    solver
        interior-point is this program's own; ipopt needs the extra wiggleroom[ipopt].
    """
    import shlex
    from dataclasses import replace

    from wiggleroom.errors import InputError

    if model != "walls":
        wrong = f"--model {model}: there is only walls"
        raise InputError(wrong)
    check(file, {"--json": (outputs.json, ()), "--picture": (outputs.picture, PICTURES)})
    answer = replace(_answer(file, asked, solver), command=shlex.join(["wiggleroom", *sys.argv[1:]]))
    if outputs.json != "-":
        from wiggleroom.cli.say import show
        from wiggleroom.report.table import table

        show(table(answer))
    write(answer, outputs)
    return 3 if answer.verdict == "stopped" else 0


def _answer(file: str, asked: Asked, solver: str) -> Answer:
    """Read, solve and measure; Ctrl-C and progress are looked after."""
    import time
    from dataclasses import replace

    from wiggleroom.assembly.findings import role_findings
    from wiggleroom.cli.watch import interruptible, progress
    from wiggleroom.errors import InputError

    begin = time.perf_counter()
    with interruptible() as stop, progress() as show:
        assembly = read(file, asked)
        lacking = role_findings(assembly.drawing)
        if lacking:
            raise InputError(lacking)
        spent = time.perf_counter() - begin

        from wiggleroom.analysis.flex import flex as solve

        answer = solve(assembly, solver=solver, stop=stop, progress=show)
    return replace(answer, seconds={"read": spent} | answer.seconds | {"total": time.perf_counter() - begin})
