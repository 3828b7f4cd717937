"""How it is taken apart and put together: the question."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from wiggleroom.context import Context
from wiggleroom.deadline import Deadline
from wiggleroom.errors import InputError, Stop
from wiggleroom.studies.question import Question

if TYPE_CHECKING:
    from wiggleroom.assembly.assembly import Assembly
    from wiggleroom.planning.plan import Plan
    from wiggleroom.planning.plan_geometry import PlanGeometry
    from wiggleroom.planning.plan_tolerance import PlanRanking, PlanSample, SmallestGap
    from wiggleroom.report.finding import Finding
    from wiggleroom.report.results.plan_results import PlanTolerances
    from wiggleroom.search.progress import Progress
    from wiggleroom.sensitivity.gap_distribution import Spread


def plan(
    assembly: Assembly,
    targets: Sequence[str] = (),
    *,
    gravity: tuple[float, ...] | None = None,
    stop: Stop | None = None,
    progress: Callable[[Progress], None] | None = None,
    seconds: float | None = None,
) -> Plan:
    """Plan the disassembly of an assembly: the parts that leave, their order and their paths.

    Fixed parts stand; if none is fixed, the largest part stands.

    Parameters
    ----------
    assembly : Assembly
    targets : sequence of names, optional
        Parts to remove; others leave only if they must.
    gravity : (x, y) or (x, y, z), optional
        Direction in which loose parts fall. Every step then lists the parts to hold so that none falls; in the plane,
        of the parts that could leave straight, those leave first after which the fewest must be held.
    stop : optional
        Anything with `is_set()`; once set, the plan so far is returned.
    progress : callable, optional
        Called with a `Progress` from time to time.
    seconds : float, optional
        Time limit; then the plan so far is returned.

    Raises
    ------
    InputError
        If a target is unknown or fixed, there is only one body, or all are fixed; if gravity has no direction.
    TouchingError
        If two parts touch at rest.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = wr.plan(wr.patterns.chain(3, joint="finger", gap=0.02))
    >>> found.order, found.level
    ((('b3',), ('b2',)), (1, 1))
    """
    from wiggleroom.assembly.assembly import require_planar
    from wiggleroom.planning.plan import plan as work_out

    if assembly.dimension == 2:
        require_planar(assembly, "plan")
    heard = progress if assembly.dimension == 2 else None  # a search in space tells numbers, not stages
    context = Context(stop=stop if seconds is None else Deadline(seconds, stop), progress=heard)
    return work_out(assembly, targets, _geometry_of, gravity, context)


def sample_plan(plan: Plan, spread: Spread, *, draws: int = 200, seed: int = 0, stop: Stop | None = None) -> PlanSample:
    """Share of assemblies with random gaps that go together along the paths of a plan.

    Parameters
    ----------
    plan : Plan
    spread : Spread
        Distribution of the extra gap round every part, whose boundary moves inward by half of it.
    draws, seed : int
    stop : optional
        Checked before every draw; once set, the draws so far are returned.

    Raises
    ------
    InputError
        If there is no plan, or it was stopped before the first draw.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> found = wr.plan(wr.patterns.chain(2, joint="finger", gap=0.05))
    >>> wr.sample_plan(found, wr.Spread(0.001), draws=5).share
    1.0
    """
    from wiggleroom.planning.plan_tolerance import sample_plan as work_out

    return work_out(plan, _geometry(plan), spread, draws, seed, Context(stop=stop))


def rank_plan(plan: Plan, *, stop: Stop | None = None) -> PlanRanking:
    """Rank the gaps by the room that a plan gains from extra gap round each part.

    In the plane paths are fitted anew.

    Raises
    ------
    InputError
        If there is no plan.
    """
    from wiggleroom.planning.plan_tolerance import rank_plan as work_out

    return work_out(plan, _geometry(plan), Context(stop=stop))


def smallest_gap(plan: Plan, *, stop: Stop | None = None) -> SmallestGap:
    """The smallest gap of the whole assembly at which a plan works.

    In the plane paths are fitted anew at every gap.

    Raises
    ------
    InputError
        If there is no plan, or the assembly has no gap of its own that could be made smaller.
    """
    from wiggleroom.planning.plan_tolerance import smallest_gap as work_out

    return work_out(plan, _geometry(plan), Context(stop=stop))


def _geometry(plan: Plan) -> PlanGeometry:
    """What is asked of the assembly of a plan."""
    from wiggleroom.disassembly.ground import with_ground

    return _geometry_of(with_ground(plan.assembly))


def _geometry_of(standing: Assembly) -> PlanGeometry:
    """What plans ask of an assembly in which something stands."""
    if standing.dimension == 3:
        from wiggleroom.spatial.spatial_plan_geometry import SpatialPlanGeometry

        return SpatialPlanGeometry(standing)
    from wiggleroom.planning.planar_plan_geometry import PlanarPlanGeometry

    return PlanarPlanGeometry(standing)


@dataclass(frozen=True, kw_only=True)
class PlanQuestion(Question):
    """Plan disassembly and, backwards, assembly: the order of parts, their paths and their clearance.

    Parts may move aside and come back, alone, as one or several at once. Fixed parts stand; if none is fixed, the
    largest part stands. Every step is checked for overlap. Exit code: 0 a plan, or nothing leaves; 3 unknown.

    Example: wiggleroom plan puzzle.svg --gap 0.2 --picture steps.html

    Example: wiggleroom plan lock.json --target bolt --json plan.json

    Example: wiggleroom plan arch.svg --gravity -y

    Parameters
    ----------
    target
        Parts to remove: A,B. May repeat. Default: all that can leave.
    gravity
        Direction in which loose parts fall, such as -y or 0.6,-0.8, in space -z. Every step then lists the parts to
        hold so that none falls.
    sample
        Also report the share of random draws that go together if the gap round every part varies by this standard
        deviation [mm].
    draws
        For --sample: number of random assemblies.
    seed
        For --sample: the same seed gives the same draws.
    rank
        Also rank the gaps by the room that they give the narrowest steps.
    smallest_gap
        Also find the smallest gap at which the plan works, to one per cent, and the failure below it.
    stills
        Folder for numbered pictures, one of every step: step_01.svg and so on.
    """

    name: ClassVar[str] = "plan"
    shows: ClassVar[Literal["curve", "path", "end"]] = "path"
    signed: ClassVar[bool] = True

    target: tuple[str, ...] = ()
    gravity: str | None = None
    sample: float | None = None
    draws: int = 200
    seed: int = 0
    rank: bool = False
    smallest_gap: bool = False
    stills: Path | None = None

    @property
    def asks_motion(self) -> bool:
        """False: nothing need be fixed or pulled."""
        return False

    def check(self, dimension: int) -> None:
        """Check the folder of stills and the numbers."""
        if self.gravity is not None:
            from wiggleroom.drawing.directions import parsed_direction

            parsed_direction("--gravity", self.gravity, dimension)
        if self.stills is not None and not self.stills.is_dir():
            finding = f"--stills {self.stills}: there is no such folder; make it first"
            raise InputError(finding)
        if self.draws < 1 or self.seed < 0:
            finding = f"--draws {self.draws} --seed {self.seed}: at least 1 and 0"
            raise InputError(finding)

    def ask(self, about: Any, context: Context) -> tuple[Plan, PlanTolerances]:
        """Plan, and ask of the plan what happens when gaps vary."""
        from wiggleroom.drawing.directions import parsed_direction
        from wiggleroom.report.results.plan_results import PlanTolerances
        from wiggleroom.sensitivity.gap_distribution import Spread

        names = tuple(name for some in self.target for name in some.split(",") if name)
        down = None if self.gravity is None else parsed_direction("--gravity", self.gravity, about.dimension)
        spread = None if self.sample is None else Spread(self.sample)
        found = plan(about, names, gravity=down, stop=context.stop, progress=context.progress)
        if not found.steps:
            return found, PlanTolerances()
        return found, PlanTolerances(
            None if spread is None else sample_plan(found, spread, draws=self.draws, seed=self.seed, stop=context.stop),
            rank_plan(found, stop=context.stop) if self.rank else None,
            smallest_gap(found, stop=context.stop) if self.smallest_gap else None,
        )

    @staticmethod
    def finding(found: tuple[Plan, PlanTolerances], command: str = "") -> Finding:
        """What was found, ready to be shown."""
        from wiggleroom.report.findings.plan import finding

        return finding(*found, command)

    def write(self, found: tuple[Plan, PlanTolerances], command: str) -> list[str]:
        """Write the stills."""
        if self.stills is None:
            return []
        from wiggleroom.report.page.plan_pictures import write_stills

        return [f"pictures: {write_stills(found[0], self.stills, command=command)} in {self.stills}"]
