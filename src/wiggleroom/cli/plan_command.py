"""`wiggleroom plan`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from wiggleroom.cli.options import RESULTS, Many, QuestionOptions, read
from wiggleroom.cli.outputs import FilmOutputs, command_line, tell
from wiggleroom.cli.running import TimeLimit
from wiggleroom.verdict import Separability

_NONE_ASKED, _NO_OUTPUTS, _ENDLESS = QuestionOptions(), FilmOutputs(), TimeLimit()


def plan(
    file: str,
    /,
    *,
    asked: QuestionOptions = _NONE_ASKED,
    outputs: FilmOutputs = _NO_OUTPUTS,
    limit: TimeLimit = _ENDLESS,
    target: Many = (),
    gravity: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    sample: float | None = None,
    draws: int = 200,
    seed: int = 0,
    rank: Annotated[bool, Parameter(negative="")] = False,
    smallest_gap: Annotated[bool, Parameter(negative="")] = False,
    stills: Annotated[Path | None, Parameter(group=RESULTS)] = None,
) -> int:
    """Plan how it is taken apart and, backwards, put together: who moves when, along which path, with how much room.

    Parts may move aside and come back, alone, as one or several at once. Fixed parts stand; where none is fixed, the
    largest part stands. Every step is checked for overlap. Exit code: 0 a plan, or nothing leaves; 3 unknown.

    Example: wiggleroom plan puzzle.svg --gap 0.2 --picture steps.html

    Example: wiggleroom plan lock.json --target bolt --json plan.json

    Example: wiggleroom plan arch.svg --gravity -y

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json).
    target
        Parts that are to leave: A,B. May repeat. By default all that can.
    gravity
        Where loose parts fall, as -y or 0.6,-0.8: every step then says whom to hold by hand so that none does.
    sample
        Also say how many draws go together when the gap round every part varies by this standard deviation [mm].
    draws
        Of --sample: assemblies drawn at random.
    seed
        Of --sample: same seed, same draws.
    rank
        Also say whose gap gives the narrowest steps more room.
    smallest_gap
        Also find the smallest gap at which the plan works, to one per cent, with what fails below it.
    stills
        A folder for numbered pictures, one of every step: step_01.svg and so on.
    """
    from wiggleroom.cli.asking import parsed_direction
    from wiggleroom.cli.running import unless_stopped
    from wiggleroom.cli.watch import interruptible, progress
    from wiggleroom.drawing.dimension import is_spatial_file
    from wiggleroom.errors import InputError

    if is_spatial_file(file):
        finding = f"plan is for drawings; {file} is an assembly in space: wiggleroom check says whether it comes apart"
        raise InputError(finding)
    outputs.check(file)
    if stills is not None and not stills.is_dir():
        finding = f"--stills {stills}: there is no such folder; make it first"
        raise InputError(finding)
    if draws < 1 or seed < 0:
        finding = f"--draws {draws} --seed {seed}: at least 1 and 0"
        raise InputError(finding)
    command = command_line()
    names = tuple(name for some in target for name in some.split(",") if name)
    with interruptible(limit.time) as stop, unless_stopped(stop), progress() as show:
        assembly = read(file, asked, stop)
        down = None if gravity is None else parsed_direction("--gravity", gravity)

        from wiggleroom.planning.plan import plan as work_out

        found = work_out(assembly, names, gravity=down, stop=stop, progress=show)

        from wiggleroom.planning import plan_tolerance as vary
        from wiggleroom.report.results.plan_results import PlanTolerances, plan_result, plan_table
        from wiggleroom.sensitivity.gap_distribution import Spread

        spread = None if sample is None else Spread(sample)
        told = PlanTolerances()
        if found.steps:
            told = PlanTolerances(
                None if spread is None else vary.sample_plan(found, spread, draws=draws, seed=seed, stop=stop),
                vary.rank_plan(found, stop=stop) if rank else None,
                vary.smallest_gap(found, stop=stop) if smallest_gap else None,
            )
    tell(outputs, lambda: plan_result(found, command, told), lambda: plan_table(found, told), found, command)
    if stills is not None:
        from wiggleroom.cli.say import note
        from wiggleroom.report.page.plan_pictures import write_stills

        count = write_stills(found, stills, command=command)
        note(f"pictures: {count} in {stills}")
    return 3 if found.verdict is Separability.UNKNOWN else 0
