"""`wiggleroom check`."""

from __future__ import annotations

import sys
from typing import Annotated

from cyclopts import Parameter

from wiggleroom.cli.options import Asked, read
from wiggleroom.cli.outputs import Outputs, tell
from wiggleroom.verdict import Separability

_NONE_ASKED, _NO_OUTPUTS = Asked(), Outputs()
CODES = {Separability.INTERLOCKED: 0, Separability.COMES_APART: 1, Separability.UNKNOWN: 3}


def check(
    file: str,
    /,
    *,
    asked: Asked = _NONE_ASKED,
    outputs: Outputs = _NO_OUTPUTS,
    largest_gap: Annotated[bool, Parameter(negative="")] = False,
    time: float | None = None,
) -> int:
    """Say whether it comes apart: whether some parts can be moved without limit away from the others.

    Says which parts leave, alone or together, in which order and along which way, every step checked for overlap; or
    that they interlock, proven or searched. Fixed parts stand; where none is fixed, the largest part stands. Turning in
    place is not coming apart. Exit code: 0 interlocked, 1 comes apart, 3 unknown.

    Example: wiggleroom check puzzle.svg --gap 0.2 --picture apart.gif

    Parameters
    ----------
    file
        A drawing (.svg, .dxf) or an assembly file (.json).
    largest_gap
        Also find the gap at which it comes apart, to 0.1 %, with a verified state on both sides.
    time
        Seconds that it may take, with the largest gap; then what is known so far is said. By default as long as it needs.
    """
    import shlex

    from wiggleroom.bound.branch_and_bound import Clock
    from wiggleroom.cli.watch import interruptible, progress
    from wiggleroom.errors import InputError, Stop

    if time is not None and not 0 < time < float("inf"):
        finding = f"--time {time:g}: it must be more than 0 seconds"
        raise InputError(finding)
    outputs.check(file)
    command = shlex.join(["wiggleroom", *sys.argv[1:]])
    with interruptible() as interrupt, progress() as show:
        stop: Stop = interrupt if time is None else Clock(time, interrupt)
        assembly = read(file, asked)

        from wiggleroom.separate.interlock import check as work_out
        from wiggleroom.separate.largest_gap import largest_gap as search

        found = work_out(assembly, stop=stop, progress=show)
        border = search(assembly, stop=stop, progress=show) if largest_gap else None
    from wiggleroom.report.apart import check_result, check_table
    from wiggleroom.report.apart_picture import Checked

    shown = Checked(found, border)
    tell(outputs, lambda: check_result(found, border, command), lambda: check_table(found, border), shown, command)
    return CODES[found.verdict]
