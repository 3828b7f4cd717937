"""Whether a certificate proves what it says.

Read this file, then `certificate_structure`, `caging_check`, `ball_bounds`, `claim` and `ball_arithmetic`: that is all. What they rest on:
python-flint (ball arithmetic), numpy, that coordinates are as given in the file, and that parts are rigid. Nothing is shared with
the code that found the proof.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import Any

from flint import arb, ctx

from wiggleroom.verify.ball_arithmetic import Refused, exact, need, point, turned
from wiggleroom.verify.ball_bounds import Case, TurnRanges, WeakDuality
from wiggleroom.verify.caging_check import Material, check_caging_surface
from wiggleroom.verify.certificate_structure import CHANGED, check_structure, read
from wiggleroom.verify.claim import Claim, claim_of, sentence
from wiggleroom.verify.work_limit import EXACT, WorkLimit

__all__ = ["Refused", "Verified", "read", "verify"]

BITS = 128


@dataclass(frozen=True)
class Verified:
    """What was found.

    Parameters
    ----------
    proven : bool
    why : str
        What is wrong, empty where nothing is.
    at_most : float [mm]
        What is stated, in radians where a turn is asked for; nothing where it is not proven.
    bodies, pairs, chords, programs : int
        How much there was to check.
    claim : Claim or None
        All that is claimed; None where it is not proven.
    """

    proven: bool
    why: str
    at_most: float
    bodies: int = 0
    pairs: int = 0
    chords: int = 0
    programs: int = 0
    claim: Claim | None = None

    def __str__(self) -> str:
        """What is proven, in a sentence, or why nothing is."""
        return f"not verified: {self.why}" if self.claim is None else f"verified: {sentence(self.claim)}"


def verify(content: Any) -> Verified:
    """Check a certificate: chords lie inside their parts, caging surfaces are closed, multipliers prove the bound.

    Parameters
    ----------
    content : dict
        `answer.bound.certificate`, or what `read` makes of a file. It is read strictly, see `certificate_structure`.

    Returns
    -------
    Verified
        It speaks of the outlines in the certificate; whether these are those of a drawing is another question.
    """
    before, ctx.prec = ctx.prec, BITS
    try:
        return _verify(content)
    except Refused as why:
        return Verified(False, str(why), 0.0)
    except (KeyError, TypeError, ValueError, IndexError, ZeroDivisionError, OverflowError) as problem:
        return Verified(False, f"the file is not made as a certificate is: {type(problem).__name__} {problem}", 0.0)
    finally:
        ctx.prec = before


def _verify(content: Any) -> Verified:
    work = WorkLimit(check_structure(content))
    rest = json.dumps({k: v for k, v in content.items() if k != "sha256"})
    need(hashlib.sha256(rest.encode()).hexdigest() == content["sha256"], CHANGED)
    for region in content["regions"]:
        check_caging_surface(region)
    chords = _check_chords(content, work)
    case = Case(content, work)
    counted = [0]
    bound = _bound(case, content["proof"], case.first(), counted)
    worked_out, stated = bound.max(case.worth), exact(content["at_most"])
    need(
        bool(worked_out <= stated),
        f"the multipliers prove {float(worked_out):.9g} only, not {float(stated):.9g}",
    )
    claim = claim_of(content)
    return Verified(True, "", float(stated), len(content["bodies"]), len(content["pairs"]), chords, counted[0], claim)


def _check_chords(content: dict[str, Any], work: WorkLimit) -> int:
    """Refuse a chord that is not inside its body, wherever a pair of bodies uses it; otherwise how many there are."""
    material = [Material(body["polygons"], work) for body in content["bodies"]]
    chords = 0
    for a, b, kind, x, y, axes in content["pairs"]:
        region, pivot, angle = content["regions"][kind], point([x, y]), exact(axes)
        for body, key in ((a, "a"), (b, "b")):
            work.spend(EXACT * len(region[key]))
            for ends in region[key]:
                p, q = (turned(point(v), angle) for v in ends)
                material[body].check(((p[0] + pivot[0], p[1] + pivot[1]), (q[0] + pivot[0], q[1] + pivot[1])))
            chords += len(region[key])
    return chords


def _bound(case: Case, step: dict[str, Any], ranges: TurnRanges, counted: list[int]) -> arb:
    """What a step proves of the goal within some ranges: what its multipliers say, or the larger of what follows its cuts."""
    if "empty" in step:
        a, b, kind = case.pairs[step["empty"]][:3]
        case.work.spend(case.enclosures[kind].steps)
        left = case.enclosures[kind].between(*ranges.pair(a, b))
        need(len(left) == 0, "a pair that should have no turn left has one")
        return arb.neg_inf()
    duality = WeakDuality(case, step["facets"], ranges)
    if "best" in step:
        counted[0] += 1
        return duality.most(step["best"], None)
    cuts = []
    for body, sign, end, multipliers in step["cuts"]:
        counted[0] += 1
        need(ranges.far[body] is not None, "a turn is cut of a body that nothing holds")
        need(
            bool(duality.most(multipliers, (body, sign)) <= sign * exact(end)),
            "multipliers do not prove a cut of a turn",
        )
        cuts.append((body, sign, end))
    with ranges.cut(cuts) as empty:
        return arb.neg_inf() if empty else _follow(case, step, ranges, counted)


def _follow(case: Case, step: dict[str, Any], ranges: TurnRanges, counted: list[int]) -> arb:
    """What the steps after some cuts prove: one, or two for both sides of a split."""
    then = step.get("then", [])
    if "split" not in step:
        need(len(then) == 1, "nothing follows the cuts of a step")
        return _bound(case, then[0], ranges, counted)
    need(len(then) == 2, "a split is not followed up on both sides")
    body, middle = step["split"]
    need(ranges.far[body] is not None, "a turn is split of a body that nothing holds")
    sides = []
    for side, sign in zip(then, (1, -1), strict=True):
        with ranges.cut([(body, sign, middle)]) as empty:
            sides.append(arb.neg_inf() if empty else _bound(case, side, ranges, counted))
    return sides[0].max(sides[1])
