"""The largest motion: the question."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from wiggleroom.errors import InputError
from wiggleroom.studies.question import Question

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from wiggleroom.context import Context
    from wiggleroom.report.finding import Finding
    from wiggleroom.search.answer import Answer


@dataclass(frozen=True, kw_only=True)
class FlexQuestion(Question):
    """Find the largest motion of the pulled parts.

    Parts are rigid and, with walls, never overlap. The answer is a motion checked by exact geometry, with a verdict on
    its certainty. Ctrl-C stops early and reports the best safe motion so far (exit 3).

    With --thickness the drawing is a cutting sheet: its plates are first assembled in space, as by wiggleroom assemble,
    and the question is answered only if that assembly is sure (else exit 3).

    Example: wiggleroom flex puzzle.svg --gap 0.2 --fix p1 --pull p20:+x --picture moved.svg

    Example: wiggleroom flex box.svg --thickness 3 --gap 0.1 --fix bottom --pull lid:+z

    Parameters
    ----------
    model
        Model of the free space of each pair. walls: the exact contacts. For comparison, hull: the convex hulls of "Mind
        the Gap"; halfplane: the linear programs of PuzzleFlex. Motions of these two may overlap, which is reported.
    about
        For hull: the point about which a part turns to determine the angles of its slices. Default: reference.
    slices
        For hull: number of slices. Default: 3, as in the paper.
    rounds
        For hull: number of times the hulls are computed, from the second time on round the last motion. Default: 1.
    solver
        interior-point is built in; ipopt needs the extra ipopt.
    search
        Number of starts besides rest, 0 for none. Each climbs with another objective for a while and then with the true
        one. Default: as many as a fixed amount of work allows, the same on every machine; none for more than 50 free
        parts (from 100 to 1,000 the first climb runs nine times instead). In space at most six, and none for more than
        six free parts.
    prove
        Prove that no motion exceeds the answer by more than this share; 0.01 is one per cent. Needs the extra prove.
        The proof takes at most a fixed amount of work, about a minute, or the time that --time leaves; then the best
        bound so far is given.
    certificate
        For --prove: file for the proof, to be checked by wiggleroom verify.
    arrays
        Write motions, waypoints and contacts as numpy arrays to this file: .npz. For drawings only.
    """

    name: ClassVar[str] = "flex"
    shows: ClassVar[Literal["curve", "path", "end"]] = "end"

    model: Literal["walls", "hull", "halfplane"] = "walls"
    about: Literal["reference", "joint"] | None = None
    slices: int | None = None
    rounds: int | None = None
    solver: Literal["interior-point", "ipopt"] = "interior-point"
    search: int | None = None
    prove: float | None = None
    certificate: Path | None = None
    arrays: Path | None = None

    def check(self, dimension: int) -> None:
        """Check that options go together, and with parts in the plane or in space."""
        hull = {k: v for k in ("about", "slices", "rounds") if (v := getattr(self, k)) is not None}
        if dimension == 3:
            planar = {
                "model": self.model != "walls",
                "arrays": self.arrays is not None,
            }
            for option, given in (planar | dict.fromkeys(hull, True)).items():
                if given:
                    wrong = f"--{option} is for parts in the plane, not for assemblies in space: leave it out"
                    raise InputError(wrong)
        if hull and self.model != "hull":
            wrong = f"--{next(iter(hull))} is for --model hull only"
            raise InputError(wrong)
        if self.certificate is not None and self.prove is None:
            raise InputError("--certificate is for --prove only")
        if self.prove is not None:
            from wiggleroom.bound.prove import check_request
            from wiggleroom.solve.dual_linear_program import need_highs

            check_request(self.prove, names=("--prove", "--time"))
            if self.model != "walls":
                wrong = f"--prove: a bound is proven with --model walls only, not {self.model}"
                raise InputError(wrong)
            need_highs()

    def places(self) -> Mapping[str, tuple[Path | None, tuple[str, ...]]]:
        """The certificate and the arrays."""
        return {"--certificate": (self.certificate, ()), "--arrays": (self.arrays, (".npz",))}

    def ask(self, about: Any, context: Context) -> Answer:
        """Find the motion, and prove a bound of it where that is wanted."""
        from wiggleroom.questions import flex, prove

        if about.dimension == 3:
            answer = flex(about, solver=self.solver, search=self.search, stop=context.stop)
        else:
            answer = flex(
                about, model=self._model(), solver=self.solver, search=self.search, stop=context.stop,
                progress=context.progress,
            )  # fmt: skip
        if self.prove is None or context.stopped:
            return answer
        done = prove(
            answer, self.prove, seconds=context.left, certify=self.certificate is not None, stop=context.stop,
            progress=context.progress,
        )  # fmt: skip
        if done.bound is None:
            return done
        return replace(done, seconds={**done.seconds, "prove": done.bound.seconds})

    def _model(self) -> Any:
        if self.model != "hull":
            return self.model
        from wiggleroom.freespace.models.pair_models import Hull

        given = {k: v for k in ("about", "slices", "rounds") if (v := getattr(self, k)) is not None}
        return Hull(**given)

    def timed(self, found: Answer, read: float, total: float) -> Answer:
        """The answer with the time [s] that reading took, and all together."""
        return replace(found, seconds={"read": read} | found.seconds | {"total": total})

    @staticmethod
    def finding(found: Answer, command: str = "") -> Finding:
        """What was found, ready to be shown."""
        from wiggleroom.report.findings.flex import finding

        return finding(replace(found, command=command) if command else found)

    @staticmethod
    def end(found: Answer) -> NDArray[Any]:
        """Where the motion has taken the parts."""
        return found.motion

    def notes(self, found: Answer) -> list[str]:
        """Why there is no nearer bound."""
        bound = found.bound
        if self.prove is None or bound is None:
            return []
        if bound.why:
            return [f"{'no bound' if found.at_most is None else 'no nearer bound'}: {bound.why}"]
        if bound.within is not None and bound.within > self.prove:
            return [f"bound: within {bound.within:.2%} of the answer; more --time may bring it nearer"]
        return []

    def write(self, found: Answer, command: str) -> list[str]:  # noqa: ARG002
        """Write the certificate and the arrays."""
        said = [] if self.certificate is None else _write_certificate(found, self.certificate)
        if self.arrays is not None:
            from wiggleroom.files import write_whole
            from wiggleroom.report.results.answer_arrays import npz

            write_whole(self.arrays, npz(found))
            said.append(f"arrays: {self.arrays}")
        return said


def _write_certificate(answer: Answer, path: Path) -> list[str]:
    """Write what was proven for `wiggleroom verify`; nothing is written where nothing was proven, which is said."""
    import json

    from wiggleroom.files import write_whole
    from wiggleroom.report.results.answer_words import rounded_up

    if answer.bound is None or answer.bound.certificate is None:
        return [f"no certificate: nothing was proven, {path} is not written"]
    paper = answer.bound.certificate
    write_whole(path, json.dumps(paper) + "\n")
    if answer.at_most is not None and paper["at_most"] > answer.at_most * (1 + 1e-9):
        proves = rounded_up(paper["at_most"])
        return [f"{path}: proves at most {proves}; the nearer bound of the answer has no certificate"]
    return []
