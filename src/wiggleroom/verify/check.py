"""Whether a certificate proves what it says.

Read this file, then `skins` and `bounds`: that is all. What they rest on: python-flint (ball arithmetic), that coordinates
are as given in the file, and that parts are rigid. Nothing is shared with the code that found the proof.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import Any

from flint import arb, ctx

from wiggleroom.verify.bounds import Case, Ranges
from wiggleroom.verify.skins import Refused, check_inside, check_skin, exact, need, point, turned

FORMAT = "wiggleroom.certificate/1"
BITS = 128
TIGHT = 1e-9
"""What is stated may lie below what was worked out by rounding alone, and above it by no more than this share."""


@dataclass(frozen=True)
class Verified:
    """What was found.

    Parameters
    ----------
    proven : bool
    why : str
        What is wrong, empty where nothing is.
    at_most : float [mm]
        What is stated; nothing where it is not proven.
    bodies, pairs, chords, programs : int
        How much there was to check.
    """

    proven: bool
    why: str
    at_most: float
    bodies: int = 0
    pairs: int = 0
    chords: int = 0
    programs: int = 0


def read(text: str) -> dict[str, Any]:
    """Content of a certificate's file; every number must stand there as it is written, so that no digit is without meaning.

    Raises
    ------
    ValueError
        If it is not JSON.
    Refused
        If a number has digits that no double needs, which `flex` never writes.
    """
    return json.loads(text, parse_float=_as_written, parse_constant=_as_written)


def _as_written(digits: str) -> float:
    number = float(digits)
    need(repr(number) == digits and abs(number) < 1e300, "the file was changed after it was written")
    return number


def verify(content: dict[str, Any]) -> Verified:
    """Check a certificate, read from JSON: chords lie inside their parts, skins are shut, multipliers prove the bound."""
    before, ctx.prec = ctx.prec, BITS
    try:
        return _verify(content)
    except Refused as why:
        return Verified(False, str(why), 0.0)
    except (KeyError, TypeError, ValueError, IndexError, ZeroDivisionError, OverflowError) as problem:
        return Verified(False, f"the file is not made as a certificate is: {type(problem).__name__} {problem}", 0.0)
    finally:
        ctx.prec = before


def _verify(content: dict[str, Any]) -> Verified:
    need(content["format"] == FORMAT, f"this is no {FORMAT}")
    rest = json.dumps({k: v for k, v in content.items() if k != "sha256"})
    need(hashlib.sha256(rest.encode()).hexdigest() == content["sha256"], "the file was changed after it was written")
    bodies, pairs = content["bodies"], content["pairs"]
    for body in bodies:
        need(isinstance(body["fixed"], bool), "a body is neither fixed nor free")
        if body["fixed"]:
            need(body["low"] == 0 and body["high"] == 0 and body["far"] == 0, "a fixed body moves")
    polygons = [[[[point(p) for p in ring] for ring in rings] for rings in body["polygons"]] for body in bodies]
    for region in content["regions"]:
        check_skin(region)
    chords = 0
    for a, b, kind, x, y, axes in pairs:
        need(min(a, b, kind) >= 0 and a != b, "a pair names nothing")
        region, pivot, angle = content["regions"][kind], point([x, y]), exact(axes)
        for body, key in ((a, "a"), (b, "b")):
            for ends in region[key]:
                p, q = (turned(point(v), angle) for v in ends)
                check_inside(((p[0] + pivot[0], p[1] + pivot[1]), (q[0] + pivot[0], q[1] + pivot[1])), polygons[body])
            chords += len(region[key])
    case = Case(content)
    counted = [0]
    bound = _bound(case, content["proof"], case.first(), counted)
    worked_out, stated = bound.max(case.worth), exact(content["at_most"])
    slack = TIGHT * (1 + abs(stated))
    need(
        bool(worked_out <= stated + slack * 1e-3),
        f"the multipliers prove {float(worked_out):.9g} only, not {float(stated):.9g}",
    )
    return Verified(True, "", float(stated), len(bodies), len(pairs), chords, counted[0])


def _bound(case: Case, step: dict[str, Any], ranges: Ranges, counted: list[int]) -> arb:
    """What a step proves of the goal within some ranges: what its multipliers say, or the larger of what follows its cuts."""
    if "empty" in step:
        a, b, kind = case.pairs[step["empty"]][:3]
        need(len(case.rooms[kind].between(*ranges.pair(a, b))) == 0, "a pair that should have no turn left has one")
        return arb.neg_inf()
    facets = step["facets"]
    if "best" in step:
        counted[0] += 1
        return case.most(ranges, facets, step["best"], None)
    low, high = list(ranges.low), list(ranges.high)
    for body, sign, end, multipliers in step["cuts"]:
        counted[0] += 1
        need(sign in (1, -1) and body >= 0, "a cut has no side")
        most = case.most(ranges, facets, multipliers, (body, sign))
        need(bool(most <= sign * exact(end)), "multipliers do not prove a cut of a turn")
        if sign > 0:
            high[body] = min(high[body], end)
        else:
            low[body] = max(low[body], end)
    if any(a is not None and a > b for a, b in zip(low, high, strict=True)):
        return arb.neg_inf()
    parts = [(low, high)]
    if "split" in step:
        body, middle = step["split"]
        need(isinstance(body, int) and body >= 0, "a split names nothing")
        parts = [(low, [*high[:body], middle, *high[body + 1 :]]), ([*low[:body], middle, *low[body + 1 :]], high)]
    need(len(step["then"]) == len(parts), "a split is not followed up on both sides")
    bounds = [_bound(case, then, ranges.cut(*part), counted) for then, part in zip(step["then"], parts, strict=True)]
    return bounds[0] if len(bounds) == 1 else bounds[0].max(bounds[1])
