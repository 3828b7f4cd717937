"""What a piece of work sends back while it runs."""

from __future__ import annotations

import math
import re
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.app.messages import encode, failed, motion_frame
from wiggleroom.app.worker_protocol import Outgoing
from wiggleroom.errors import go_on
from wiggleroom.schema.replies import Fault, ProgressReply
from wiggleroom.schema.reply_base import Reply

PROGRESS_INTERVAL = 0.05
"""Progress is told no more often than this [s]."""


class Reporter:
    """Replies of one request.

    Parameters
    ----------
    ticket, number : int
        Of this piece of work, and of the request.
    kind : str
    stop : threading.Event
        Set when the work is to end.
    say : callable
        Takes messages to the server.
    quiet : bool
        True: nothing is sent.
    """

    def __init__(
        self, ticket: int, number: int, kind: str, stop: threading.Event, say: Callable[[object], None], quiet: bool
    ) -> None:
        self.ticket, self.number, self.kind, self.stop = ticket, number, kind, stop
        self._say, self._quiet, self._last = say, quiet, 0.0

    def reply(self, content: Reply, motions: Sequence[NDArray[np.float64]] = ()) -> None:
        """Send a reply, and before it motions, each (k, n, 3) [mm, mm, rad], or in space (k, n, 7)."""
        content.id = self.number
        if not self._quiet:
            self._say(Outgoing(self.ticket, encode(content), [motion_frame(self.number, m) for m in motions]))

    def failed(self, findings: Sequence[str], review: Sequence[Fault] = ()) -> None:
        """Say what is wrong, one line each, and everything that is wrong with the design."""
        if not self._quiet:
            content = failed(self.number, self.kind, [on_the_page(line) for line in findings])
            if review:
                content.review = list(review)
            self._say(Outgoing(self.ticket, encode(content)))

    def check(self) -> None:
        """End here where the work is to stop."""
        go_on(self.stop)

    def progress(self, now: Any) -> None:
        """Tell an analysis' `Progress`."""
        value = now.objective
        known = value is not None and math.isfinite(value)
        self._progress(now.stage, now.round, now.iteration, value if known else None, None)

    def iterated(self, iteration: int, value: float) -> None:
        """Tell an iteration of a solver and what it has reached."""
        self._progress("solve", 0, iteration, value if math.isfinite(value) else None, None)

    def counted(self, done: int, total: int) -> None:
        """Tell how many of how many are done; ends the work where it is to stop."""
        self.check()
        self._progress("", 0, 0, None, done / total if total else None)

    def _progress(self, stage: str, turn: int, iteration: int, objective: float | None, share: float | None) -> None:
        now = time.monotonic()
        if now - self._last < PROGRESS_INTERVAL:
            return
        self._last = now
        self.reply(
            ProgressReply(
                kind_of=self.kind, stage=stage, round=turn, iteration=iteration, objective=objective, share=share
            )
        )


def on_the_page(line: str) -> str:
    """Finding without the options of commands.

    >>> on_the_page("no room to move: give a gap, for example --gap 0.2")
    'no room to move: give a gap, for example 0.2 mm'
    """
    for option, words in _WORDS:
        line = re.sub(option, words, line)
    return line


_WORDS = (
    (r"name the parts that stand with --fix NAME", "choose a part that stands"),
    (r"say what moves with --pull NAME:\+y", "choose what is pulled, and which way"),
    (r"say what moves with --pull NAME:\+z", "choose what is pulled, and which way"),
    (r", and a hint \(\[\[plate\]\]\) can say where", ": lay it on another"),
    (r" \(\[\[plate\]\]\)", ""),
    (r"as cut: --relieve \S+ would move every outline inward by that", "as cut"),
    (r": --burn (\S+) says it, --burn 0 that it is not so", r": a burn of \1 mm says it, one of 0 that it is not so"),
    (r"--gap (\S+)", r"\1 mm"),
    (r"; --solid NAME, @x,y or all makes parts of them", "; “parts, not holes” takes them as parts"),
    (r"; --hole NAME, @x,y or all makes holes of them", "; “holes” cuts them out"),
    (r"--hole (\S+) if it is cut out", r"“holes” with \1 if it is cut out"),
    (r"--hole (\S+) says so", r"“holes” with \1 says so"),
    (r"--solid (\S+) makes (?:it a part|a part of it)", r"“parts, not holes” with \1 makes it a part"),
    (r" \(--unit(?: and --dpi)? says? otherwise\)", ""),
    (r"; --unit and --dpi say otherwise", ""),
    (r"--skip (\S+) if it is the sheet", r"“leave out” with \1 if it is the sheet"),
    (r"\(--skip (\S+) leaves it out\)", r"(“leave out” with \1 ignores it)"),
    (r"; --solid NAME\|all reads it as a part", "; “parts, not holes” takes it as a part"),
    (r" \(--join sets how far\)", "; “join ends” sets how far"),
    (r"--join (\S+) closes it", r"“join ends” of \1 mm closes it"),
    (r"; --skip COLOUR leaves one out", "; “leave out” takes one away"),
    (r" \(--(?:skip|only)\)", ""),
    (r"; --only (\"[^\"]*\"|\S+) reads it", r"; “read only” with \1 reads it"),
)
