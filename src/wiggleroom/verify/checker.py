"""Whether a certificate proves what it says.

Read this file, then `certificate_structure`, `caging_check`, `chord_check`, `known_ranges`, `ball_bounds`, `claim` and
`ball_arithmetic`: that is all. Of a certificate in space read `space_checker`, `space_claim`, `work_limit` and `ball_arithmetic`.
What they rest on: python-flint (ball arithmetic), numpy, that coordinates are as given in the file,
and that parts are rigid. Nothing is shared with the code that found the proof.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from flint import arb, ctx

from wiggleroom.verify.ball_arithmetic import Point, Refused, exact, less, need, point, size, turned
from wiggleroom.verify.ball_bounds import RangedCase
from wiggleroom.verify.caging_check import check_caging_surface
from wiggleroom.verify.certificate_structure import check_structure, check_unchanged, read_certificate
from wiggleroom.verify.chord_check import Material
from wiggleroom.verify.claim import Claim, claim_of, sentence
from wiggleroom.verify.known_ranges import Bodies, Case, Enclosure
from wiggleroom.verify.space_checker import SpatialClaim, in_space, verify_spatial
from wiggleroom.verify.space_claim import spatial_sentence
from wiggleroom.verify.work_limit import EXACT, WorkLimit

__all__ = ["Refused", "Verified", "read_certificate", "verify"]

BITS = 128
"""Precision of ball arithmetic: more than twice that of doubles."""


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
        In space: bodies, convex pieces, points and linear programs.
    claim : Claim or SpatialClaim or None
        All that is claimed; None where it is not proven.
    """

    proven: bool
    why: str
    at_most: float
    bodies: int = 0
    pairs: int = 0
    chords: int = 0
    programs: int = 0
    claim: Claim | SpatialClaim | None = None

    def __str__(self) -> str:
        """What is proven, in a sentence, or why nothing is."""
        if self.claim is None:
            return f"not verified: {self.why}"
        said = spatial_sentence(self.claim) if isinstance(self.claim, SpatialClaim) else sentence(self.claim)
        return f"verified: {said}"


def verify(content: Any) -> Verified:
    """Check a certificate: chords lie inside their parts, caging surfaces are closed, multipliers prove the bound.

    Parameters
    ----------
    content : dict
        `answer.bound.certificate`, or what `read_certificate` makes of a file. It is read strictly, see `certificate_structure`.

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
    if in_space(content):
        claim, counts = verify_spatial(content)
        return Verified(True, "", claim.at_most, 2, counts.pieces, counts.points, counts.programs, claim)
    work = WorkLimit(check_structure(content))
    check_unchanged(content)
    for region in content["regions"]:
        check_caging_surface(region)
    chords = _check_chords(content, work)
    bodies = content["bodies"]
    case = Case(
        Bodies([point(body["origin"]) for body in bodies], [body["fixed"] for body in bodies]),
        [Enclosure(region) for region in content["regions"]],
        content["pairs"],
        content["goal"],
        exact(content["worth"]),
        work,
    )
    counted = [0]
    for window in content["windows"]:
        _check_window(case, window, counted)
    low, high, far = ([body[key] for body in bodies] for key in ("low", "high", "far"))
    case.first(low, high, far, [body["parts"][0] for body in bodies])
    bound = _bound(case, content["proof"], (low, high, far), counted)
    worked_out, stated = bound.max(case.worth), exact(content["at_most"])
    need(
        bool(worked_out <= stated),
        f"the multipliers prove {float(worked_out):.9g} only, not {float(stated):.9g}",
    )
    planar = claim_of(content)
    return Verified(True, "", float(stated), len(content["bodies"]), len(content["pairs"]), chords, counted[0], planar)


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


def _check_window(case: Case, window: dict[str, Any], counted: list[int]) -> None:
    """Turns against the first body of a window, as its own steps prove them, become known in all placements that really are alike.

    Within a window a body's origin is the pivot of its first pair there, so its outline does not matter.
    """
    placements, pairs = window["placements"], window["pairs"]
    bodies = placements[0]
    number = {k: i for i, k in enumerate(bodies)}
    own = []
    for p in pairs[0]:
        a, b, *rest = case.pairs[p]
        need(a in number and b in number, "a pair of a window has a body outside it")
        own.append([number[a], number[b], *rest])
    doubt = max(
        (_unlike(case, placements[0], pairs[0], *other) for other in zip(placements, pairs, strict=True)), default=0.0
    )
    origin = _first_pivots(case, pairs[0])
    small = Case(
        Bodies([origin.get(k, case.origin[k]) for k in bodies], [k == 0 for k in range(len(bodies))]),
        case.enclosures,
        own,
        [],
        case.worth,
        case.work,
        exact(doubt),
    )
    # what holds of a pair in every placement, not only in the first
    for at, joined in enumerate(zip(*pairs, strict=True)):
        case.work.spend(len(joined))
        small.narrow(at, min(case.known[p][2] for p in joined), max(case.known[p][3] for p in joined))
    small.known += _known_in_all(case, placements)
    first = window["steps"][0]
    ranges = first["low"], first["high"], window["far"]
    small.first(*ranges, [f"body {k} of a window" for k in range(len(bodies))])
    for step in window["steps"]:
        ranges = _stated(small, step, ranges)
        ranges = _cut(small, step, ranges, counted, worth=False)
    low, high = window["low"], window["high"]
    for k in range(1, len(bodies)):
        fits = low[k] <= min(ranges[0][k], 0) and high[k] >= max(ranges[1][k], 0)
        need(fits, "the steps of a window do not prove what it says of turns")
    for placement in placements:
        for k in range(1, len(bodies)):
            case.learn(placement[0], placement[k], low[k], high[k])


def _known_in_all(case: Case, placements: list[list[int]]) -> list[tuple[int, int, float, float]]:
    """What windows before have shown of turns between two places of this one in every placement, not only in the first.

    One placement may have neighbours that another one lacks, and so turn less.
    """
    shown = case.known[len(case.pairs) :]
    case.work.spend(len(case.known))
    tightest: dict[tuple[int, int], tuple[float, float]] = {}
    for a, b, low, high in shown:
        for key, one, two in (((a, b), low, high), ((b, a), -high, -low)):
            least, most = tightest.get(key, (-math.inf, math.inf))
            tightest[key] = max(least, one), min(most, two)
    place = {k: i for i, k in enumerate(placements[0])}
    asked = {(place[a], place[b]) for a, b, *_ in shown if a in place and b in place}
    found = []
    for i, j in sorted(asked):
        case.work.spend(len(placements))
        ends = [tightest.get((row[i], row[j]), (-math.inf, math.inf)) for row in placements]
        low, high = min(one for one, _ in ends), max(two for _, two in ends)
        if low > -math.inf:
            found.append((i, j, low, high))
    return found


def _first_pivots(case: Case, pairs: list[int]) -> dict[int, Point]:
    """For each body the pivot at rest of the first of some pairs that it belongs to."""
    found: dict[int, Point] = {}
    for p in pairs:
        a, b, _, x, y, _ = case.pairs[p]
        for body in (a, b):
            found.setdefault(body, point([x, y]))
    return found


def _unlike(case: Case, bodies: list[int], pairs: list[int], others: list[int], joined: list[int]) -> float:
    """How much the equations of two windows may differ [mm], the second turned like its first pair; infinite where they are not alike.

    A pivot at p from an origin, turned by at most half a turn, moves by (R - 1) p: an arm that differs by d changes that by at most 2 d.
    """
    place = dict(zip(bodies, others, strict=True))
    need(len(set(others)) == len(others), "a window names a body twice")
    turn = exact(case.pairs[joined[0]][5]) - exact(case.pairs[pairs[0]][5])
    first, second = _first_pivots(case, pairs), _first_pivots(case, joined)
    worst = 0.0
    for p, q in zip(pairs, joined, strict=True):
        a, b, kind, x, y, axes = case.pairs[p]
        c, d, other, u, v, turned_axes = case.pairs[q]
        need((place[a], place[b], kind) == (c, d, other), "a placement of a window joins other bodies")
        case.work.spend(EXACT)
        away = exact(turned_axes) - exact(axes) - turn
        half = (away / 2).sin()
        apart = abs(2 * half) * exact(case.enclosures[kind].far)
        for one, two in ((a, c), (b, d)):
            arm = turned(less(point([x, y]), first[one]), turn)
            apart += 2 * size(less(arm, less(point([u, v]), second[two])))
        worst = max(worst, float(apart.upper()))
    return worst


def _stated(case: Case, step: dict[str, Any], ranges: tuple[list, list, list]) -> tuple[list, list, list]:
    """Ranges that a step names, which must be no narrower than what is known."""
    low, high, far = ranges
    need(len(step["low"]) == len(step["high"]) == len(case.fixed), "ranges of a step are not complete")
    for k, (one, two) in enumerate(zip(step["low"], step["high"], strict=True)):
        if one is None or two is None:
            need(one is None and two is None, "a body's range is not complete")
        else:
            fits = low[k] is not None and one <= low[k] and high[k] <= two
            need(fits, "nothing shows that a body stays within the range of a step")
    return step["low"], step["high"], far


def _cut(
    case: Case, step: dict[str, Any], ranges: tuple[list, list, list], counted: list[int], worth: bool = True
) -> tuple[list, list, list]:
    """Ranges after the cuts of a step, each of which its multipliers prove."""
    stage = RangedCase(case, *ranges, step["turns"])
    low, high = list(ranges[0]), list(ranges[1])
    base = stage.base(step["base"]) if "base" in step else None
    for body, sign, end, multipliers in step["cuts"]:
        counted[0] += 1
        need(low[body] is not None and ranges[2][body] is not None, "a turn is cut of a body that nothing holds")
        need(worth or multipliers[1] == 0, "a window asks what motions are worth")
        proven = stage.most(multipliers, (body, sign), base)
        need(bool(proven <= sign * exact(end)), "multipliers do not prove a cut of a turn")
        if sign > 0:
            high[body] = min(high[body], end)
        else:
            low[body] = max(low[body], end)
    return (*case.spread(low, high), ranges[2])


def _bound(case: Case, step: dict[str, Any], ranges: tuple[list, list, list], counted: list[int]) -> arb:
    """What a step proves of the goal within some ranges: what its multipliers say, or the larger of what follows its cuts."""
    ranges = _stated(case, step, ranges)
    if "empty" in step:
        p = step["empty"]
        stage = RangedCase(case, *ranges, [list(case.known[k][2:]) for k in range(len(case.pairs))])
        least, most = stage.pair(p)
        enclosure = case.enclosures[case.pairs[p][2]]
        case.work.spend(enclosure.steps)
        left = least <= most and len(enclosure.between(least, most)) > 0
        need(not left, "a pair that should have no turn left has one")
        return arb.neg_inf()
    if "best" in step:
        counted[0] += 1
        return RangedCase(case, *ranges, step["turns"]).most(step["best"], None)
    low, high, far = _cut(case, step, ranges, counted)
    if _empty(low, high):
        return arb.neg_inf()
    then = step.get("then", [])
    if "split" not in step:
        need(len(then) == 1, "nothing follows the cuts of a step")
        return _bound(case, then[0], (low, high, far), counted)
    need(len(then) == 2, "a split is not followed up on both sides")
    body, middle = step["split"]
    need(low[body] is not None, "a turn is split of a body that nothing holds")
    sides = []
    for side, sign in zip(then, (1, -1), strict=True):
        one, two = list(low), list(high)
        if sign > 0:
            two[body] = min(two[body], middle)
        else:
            one[body] = max(one[body], middle)
        sides.append(arb.neg_inf() if one[body] > two[body] else _bound(case, side, (one, two, far), counted))
    return sides[0].max(sides[1])


def _empty(low: list, high: list) -> bool:
    """Whether some body is left no turn."""
    return any(one is not None and one > two for one, two in zip(low, high, strict=True))
