"""`wiggleroom flex`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from wiggleroom.cli.options import QuestionOptions, read
from wiggleroom.cli.outputs import Outputs, command_line, tell, write_moved
from wiggleroom.cli.running import TimeLimit
from wiggleroom.cli.sheet_options import SheetOptions
from wiggleroom.verdict import Verdict

if TYPE_CHECKING:
    from wiggleroom.freespace.models.pair_models import PairModel
    from wiggleroom.search.answer import Answer

_NONE_ASKED, _NO_OUTPUTS, _ENDLESS, _NO_SHEET = QuestionOptions(), Outputs(), TimeLimit(), SheetOptions()


def flex(
    file: str,
    /,
    *,
    asked: QuestionOptions = _NONE_ASKED,
    sheet: SheetOptions = _NO_SHEET,
    outputs: Outputs = _NO_OUTPUTS,
    limit: TimeLimit = _ENDLESS,
    model: Literal["walls", "hull", "halfplane"] = "walls",
    about: Literal["reference", "joint"] | None = None,
    slices: int | None = None,
    rounds: int | None = None,
    solver: Literal["interior-point", "ipopt"] = "interior-point",
    search: int | None = None,
    prove: float | None = None,
    certificate: Path | None = None,
    arrays: Path | None = None,
) -> int:
    """Find the largest motion of the pulled parts.

    Parts are rigid and, with walls, never overlap. The answer is a motion that was found and checked by exact geometry,
    with a verdict on how sure it is. Ctrl-C stops early and reports the best safe motion so far (exit 3).

    With --thickness a drawing is a cutting sheet: its plates are put together in space first, as wiggleroom assemble
    does, and the question is answered only where that is sure (else exit 3).

    Example: wiggleroom flex puzzle.svg --gap 0.2 --fix p1 --pull p20:+x --picture moved.svg

    Example: wiggleroom flex box.svg --thickness 3 --gap 0.1 --fix bottom --pull lid:+z

    Parameters
    ----------
    file
        A drawing (.svg, .dxf, .lbrn2) or an assembly file (.json), of the plane or of space.
    model
        How the free space of each pair is modelled: walls, the exact contacts; to compare with, hull, the convex hulls
        of "Mind the Gap", or halfplane, the linear programs of PuzzleFlex. These two may overlap, which is told.
    about
        For hull: the point that a part turns about to find the angles of its slices. By default reference.
    slices
        For hull: number of slices. By default 3, as in the paper.
    rounds
        For hull: so often the hulls are worked out, from the second time on round the motion found. By default 1.
    solver
        interior-point is this program's own; ipopt needs the extra ipopt.
    search
        So many starts beside the one from rest: each climbs with another objective for a while and then with the true
        one; 0 for none. By default as many as a fixed amount of work allows, the same on every machine; none for more
        than 50 free parts (from 100 to 1,000 the first climb is made nine times instead). In space by default at most six,
        and none for more than six free parts.
    prove
        Prove a bound: that no motion is worth more than this share above the answer; 0.01 is one per cent. Needs the
        extra prove. The proof may take a fixed amount of work, about a minute, or else the time that --time leaves;
        then the best bound so far is given.
    certificate
        For --prove: file for the proof, which wiggleroom verify checks.
    arrays
        Write motions, waypoints and contacts as numpy arrays to this file: .npz. Of drawings only.
    """
    from dataclasses import replace

    from wiggleroom.errors import InputError
    from wiggleroom.freespace.models.pair_models import Hull

    settings: dict[str, Any] = {
        k: v for k, v in (("about", about), ("slices", slices), ("rounds", rounds)) if v is not None
    }
    from wiggleroom.drawing.dimension import is_spatial_file

    sheet.check(file)
    if sheet.given or is_spatial_file(file):
        for option, given in (
            ("model", model != "walls"),
            ("prove", prove is not None),
            ("arrays", arrays is not None),
            *((k, True) for k in settings),
        ):
            if given:
                wrong = f"--{option} is for parts in the plane; {file} is asked in space: leave it out"
                raise InputError(wrong)
        from wiggleroom.cli.in_space import flex_in_space

        return flex_in_space(file, asked, outputs, solver, search, limit.time, sheet)
    if settings and model != "hull":
        wrong = f"--{next(iter(settings))} is for --model hull only"
        raise InputError(wrong)
    if certificate is not None and prove is None:
        raise InputError("--certificate is for --prove only")
    if prove is not None:
        from wiggleroom.cli.proving import check_proof

        check_proof(prove, model)
    outputs.check(file, **{"--certificate": (certificate, ()), "--arrays": (arrays, (".npz",))})
    command = command_line()
    wanted = Hull(**settings) if model == "hull" else model
    answer = replace(
        _answer(file, asked, wanted, solver, search, prove, limit.time, certificate is not None), command=command
    )
    from wiggleroom.report.results.json_results import flex_result
    from wiggleroom.report.results.table import table

    if certificate is not None:
        from wiggleroom.cli.proving import write_certificate

        write_certificate(answer, certificate)
    tell(outputs, lambda: flex_result(answer), lambda: table(answer), answer, command)
    write_moved(answer.assembly, answer.motion, outputs.moved)
    if arrays is not None:
        from wiggleroom.cli.say import note
        from wiggleroom.files import write_whole
        from wiggleroom.report.results.answer_arrays import npz

        write_whole(arrays, npz(answer))
        note(f"arrays: {arrays}")
    return 3 if answer.verdict is Verdict.STOPPED else 0


def _answer(
    file: str,
    asked: QuestionOptions,
    model: str | PairModel,
    solver: str,
    search: int | None,
    prove: float | None,
    seconds: float | None,
    certify: bool,
) -> Answer:
    """Read, solve and measure; Ctrl-C and progress are looked after."""
    import time
    from dataclasses import replace

    from wiggleroom.assembly.findings import role_findings
    from wiggleroom.cli.running import unless_stopped
    from wiggleroom.cli.watch import interruptible, progress
    from wiggleroom.errors import InputError

    begin = time.perf_counter()
    with interruptible(seconds) as stop, unless_stopped(stop), progress() as show:
        assembly = read(file, asked, stop)
        lacking = role_findings(assembly.drawing)
        if lacking:
            raise InputError(lacking)
        spent = time.perf_counter() - begin

        from wiggleroom.maximise import flex as solve

        answer = solve(assembly, model=model, solver=solver, search=search, stop=stop, progress=show)
        if prove is not None and not stop.is_set():
            from wiggleroom.cli.proving import with_proof

            answer = with_proof(answer, prove, certify, stop, show)
    return replace(answer, seconds={"read": spent} | answer.seconds | {"total": time.perf_counter() - begin})
