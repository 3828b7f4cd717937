"""`wiggleroom rank`."""

from __future__ import annotations

import sys
from typing import Literal

from wiggleroom.cli.options import Asked, read
from wiggleroom.cli.outputs import PICTURES, Outputs, check, write_picture, write_record
from wiggleroom.cli.running import Running, complete, unless_stopped

_NONE_ASKED, _NO_OUTPUTS, _HERE = Asked(), Outputs(), Running()


def rank(
    file: str,
    /,
    *,
    asked: Asked = _NONE_ASKED,
    outputs: Outputs = _NO_OUTPUTS,
    running: Running = _HERE,
    by: Literal["duals", "differences"] = "duals",
    exact: bool = False,
) -> int:
    """Say which parts' gaps, and which joints', matter most for the motion.

    Importance is mm of motion for each mm of extra gap round one part: its outline alone moves inward by half of it.

    Example: wiggleroom rank puzzle.svg --gap 0.2 --fix p1 --pull p20:+x --picture blame.svg

    Parameters
    ----------
    file
        A drawing (.svg) or an assembly file (.json).
    by
        duals: all parts from the forces of one solve. differences: solved again for every part, as a check.
    exact
        Solve again for the parts whose importance the forces leave open.
    """
    import shlex

    from wiggleroom.cli.watch import bar, interruptible

    check(file, {"--json": (outputs.json, ()), "--picture": (outputs.picture, PICTURES)})
    command = shlex.join(["wiggleroom", *sys.argv[1:]])
    options = running.options()
    with interruptible() as stop, unless_stopped(stop), bar("differences") as show:
        assembly = complete(read(file, asked))

        from wiggleroom.analysis.rank import rank as work_out

        ranking = work_out(assembly, by=by, exact=exact, stop=stop, progress=show, **options)
    from wiggleroom.report.ranking import rank_record, rank_table

    if outputs.json is not None:
        write_record(rank_record(ranking, command), outputs.json)
    if outputs.json != "-":
        from wiggleroom.cli.say import show as print_page

        print_page(rank_table(ranking))
    if outputs.picture is not None:
        from wiggleroom.report.blame import picture_of_ranking

        write_picture(picture_of_ranking(ranking, command=command), outputs.picture)
    return 0
