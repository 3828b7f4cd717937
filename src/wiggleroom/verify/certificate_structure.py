"""The strict reader: what a certificate may look like at all. Everything else is refused before anything is worked out.

The command and `verify` of a dictionary both come through here. Every field must be there and no other, every number finite and within
its range, every index must name something, no name may stand twice.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from typing import Any

from wiggleroom.verify.ball_arithmetic import Refused, cross, less, need, point

FORMAT = "wiggleroom.certificate/4"
CHANGED = "the file was changed after it was written"

LENGTH, ANGLE, FACTOR = 1e12, 1e6, 1e100
"""Largest lengths [mm], angles [rad] and multipliers that are read."""
DEEPEST = 256
"""Most steps of a proof that may follow each other."""

TOP = {"format", "gap", "turns", "at_most", "worth", "bodies", "goal", "regions", "pairs", "windows", "proof", "sha256"}
BODY = {"parts", "fixed", "origin", "polygons", "low", "high", "far"}
REGION = {"a", "b", "loops", "seams"}
WINDOW = {"placements", "pairs", "far", "steps", "low", "high"}
STEP = {"low", "high", "turns"}


def read_certificate(text: str) -> dict[str, Any]:
    """Content of a certificate's file; every number must stand there as it is written, so that no digit is without meaning.

    Raises
    ------
    ValueError
        If it is not JSON.
    Refused
        If a number has digits that no double needs, a key stands twice or brackets are nested too deeply: `flex` writes none of these.
    """
    try:
        return json.loads(
            text, parse_float=_as_written, parse_constant=_as_written, parse_int=_whole, object_pairs_hook=_once
        )
    except RecursionError:
        raise Refused("brackets are nested too deeply") from None


def check_unchanged(content: dict[str, Any]) -> None:
    """Refuse a certificate that is not what its digest was made of."""
    rest = json.dumps({k: v for k, v in content.items() if k != "sha256"})
    need(hashlib.sha256(rest.encode()).hexdigest() == content["sha256"], CHANGED)


def _as_written(digits: str) -> float:
    number = float(digits)
    need(repr(number) == digits and abs(number) < 1e300, CHANGED)
    return number


def _whole(digits: str) -> int:
    need(len(digits) < 20 and str(int(digits)) == digits, CHANGED)
    return int(digits)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    need(len(found) == len(pairs), "a key stands twice")
    return found


def check_structure(content: Any) -> int:
    """Refuse what is not made as a certificate is; otherwise how many numbers there are.

    Parameters
    ----------
    content : dict
        As read from JSON.
    """
    return _StructureCheck().whole(content)


class _StructureCheck:
    """Goes once through a certificate and counts its numbers."""

    def __init__(self) -> None:
        self.numbers = 0

    def whole(self, content: Any) -> int:
        _keys(content, TOP, "the certificate")
        need(content["format"] == FORMAT, f"this is no {FORMAT}")
        need(isinstance(content["sha256"], str), "the checksum is no text")
        self.number(content["gap"], LENGTH, "the gap")
        need(content["gap"] >= 0, f"the gap is {content['gap']:g}: it must be 0 or more")
        self.number(content["at_most"], LENGTH, "what is stated")
        self.number(content["worth"], LENGTH, "what is stated")
        self.bodies(content["bodies"])
        self.goal(content["goal"], content["bodies"], content["turns"])
        regions = _rows(content["regions"], "regions")
        for region in regions:
            self.region(region)
        bodies = len(content["bodies"])
        for a, b, kind, *spot in _rows(content["pairs"], "pairs", 6):
            self.index(a, bodies, "pairs")
            self.index(b, bodies, "pairs")
            self.index(kind, len(regions), "pairs")
            need(a != b, "a pair names one body twice")
            self.lengths(spot[:2], "pairs")
            self.number(spot[2], ANGLE, "pairs")
        for window in _rows(content["windows"], "windows"):
            self.window(window, bodies, len(content["pairs"]))
        self.proof(content["proof"], bodies, len(content["pairs"]))
        return self.numbers

    def number(self, value: Any, most: float, where: str) -> None:
        self.numbers += 1
        fits = type(value) is float or (type(value) is int and abs(value) <= 2**53)
        if not (fits and math.isfinite(value) and abs(value) <= most):
            _refuse(where, value, "is no number that can be used")

    def index(self, value: Any, count: int, where: str) -> None:
        self.numbers += 1
        if not (type(value) is int and 0 <= value < count):
            _refuse(where, value, "names nothing")

    def lengths(self, values: list, where: str) -> None:
        for value in values:
            self.number(value, LENGTH, where)

    def points(self, rows: Any, where: str) -> None:
        for row in _rows(rows, where, 2):
            self.lengths(row, where)

    def bodies(self, bodies: Any) -> None:
        names: list[str] = []
        for body in _rows(bodies, "bodies"):
            _keys(body, BODY, "a body")
            parts = _rows(body["parts"], "parts")
            need(len(parts) > 0 and all(isinstance(n, str) and n for n in parts), "a body has no parts with names")
            names += parts
            need(isinstance(body["fixed"], bool), "a body is neither fixed nor free")
            need(isinstance(body["origin"], list) and len(body["origin"]) == 2, "an origin is no point")
            self.lengths(body["origin"], "bodies")
            polygons = _rows(body["polygons"], "polygons")
            need(len(polygons) > 0, f"{_shown(parts[0])} has no outline")
            for rings in polygons:
                need(len(_rows(rings, "polygons")) > 0, f"{_shown(parts[0])} has no outline")
                for hole, ring in enumerate(rings):
                    self.points(ring, "polygons")
                    _check_ring(ring, hole > 0)
            self.ranges(body)
        need(len(set(names)) == len(names), "a part stands in two bodies")
        need(any(body["fixed"] for body in bodies), "nothing is fixed")

    def ranges(self, body: dict[str, Any]) -> None:
        ends = body["low"], body["high"], body["far"]
        if any(end is None for end in ends):
            need(all(end is None for end in ends) and not body["fixed"], "a body's range is not complete")
            return
        for end in ends[:2]:
            self.number(end, ANGLE, "ranges")
        self.number(ends[2], LENGTH, "ranges")
        need(ends[0] <= 0 <= ends[1] and ends[2] >= 0, "a body's range does not hold rest")
        need(not body["fixed"] or ends == (0, 0, 0), "a fixed body moves")

    def goal(self, goal: Any, bodies: list, turns: Any) -> None:
        need(len(_rows(goal, "goal", 6)) > 0, "nothing is asked")
        for body, dx, dy, x, y, spin in goal:
            self.index(body, len(bodies), "goal")
            need(not bodies[body]["fixed"], f"{_shown(bodies[body]['parts'][0])} is asked about and fixed")
            self.lengths([dx, dy, x, y, spin], "goal")
            need(any((dx, dy, spin)), "a goal asks for nothing")
        need(isinstance(turns, bool), "it is not said whether a turn is asked for")
        need(turns == all(row[1] == row[2] == 0 for row in goal), "the unit does not belong to what is asked")

    def region(self, region: Any) -> None:
        _keys(region, REGION, "a region")
        for key in ("a", "b"):
            for chord in _rows(region[key], "chords", 2):
                self.points(chord, "chords")
        sizes = []
        for angle, at in _rows(region["loops"], "loops", 2):
            self.number(angle, ANGLE, "loops")
            self.points(at, "loops")
            need(len(at) > 0, "a loop has no corner")
            sizes.append(len(at))
        seams = _rows(region["seams"], "seams", 2)
        need(len(sizes) >= 3 and len(seams) == len(sizes) - 1, "loops and seams do not fit together")
        for k, (tracks, chords) in enumerate(seams):
            for row in _rows(tracks, "tracks", 2):
                self.index(row[0], sizes[k], "tracks")
                self.index(row[1], sizes[k + 1], "tracks")
            for row in _rows(chords, "chords", 2):
                self.index(row[0], len(region["a"]), "chords")
                self.index(row[1], len(region["b"]), "chords")

    def window(self, window: Any, bodies: int, pairs: int) -> None:
        _keys(window, WINDOW, "a window")
        placements, joined = _rows(window["placements"], "windows"), _rows(window["pairs"], "windows")
        need(0 < len(placements) == len(joined), "a window's placements are not complete")
        size, wide = len(_rows(placements[0], "windows")), len(_rows(joined[0], "windows"))
        need(size >= 2 and wide >= 1, "a window is too small")
        for rows, count, named in ((placements, size, bodies), (joined, wide, pairs)):
            for row in _rows(rows, "windows", count):
                for k in row:
                    self.index(k, named, "windows")
                need(len(set(row)) == count, "a window names a body or a pair twice")
        self.numbers += 10 * len(placements) * size
        for key, most in (("far", LENGTH), ("low", ANGLE), ("high", ANGLE)):
            need(len(_rows(window[key], "windows")) == size, "a window's ranges are not complete")
            for value in window[key]:
                self.number(value, most, "windows")
        steps = _rows(window["steps"], "windows")
        need(len(steps) > 0, "a window has no steps")
        for step in steps:
            need(
                isinstance(step, dict) and not {"best", "empty", "split", "base"} & set(step),
                "a window's step does more than cut",
            )
            need(None not in step.get("low", [None]), "a window's step has no ranges")
            _rows(step.get("then", []), "windows")
            need(not step.get("then"), "a window's step is followed by another one")
            self.step(step, size, wide)

    def proof(self, proof: Any, bodies: int, pairs: int) -> None:
        todo, seen = [(proof, 0)], set()
        while todo:
            step, depth = todo.pop()
            need(depth < DEEPEST, "its proof is nested too deeply")
            need(isinstance(step, dict) and id(step) not in seen, "a step of the proof is no step of its own")
            seen.add(id(step))
            todo += [(then, depth + 1) for then in self.step(step, bodies, pairs)]

    def step(self, step: dict[str, Any], bodies: int, pairs: int) -> list:
        """Steps that follow."""
        self.numbers += 1
        for key in ("low", "high"):
            need(len(_rows(step.get(key), "ranges")) == bodies, "ranges of a step are not complete")
            for value in step[key]:
                if value is not None:
                    self.number(value, ANGLE, "ranges")
        if "empty" in step:
            _keys(step, {"low", "high", "empty"}, "a step")
            self.index(step["empty"], pairs, "proof")
            return []
        best = "best" in step
        more = {"then", "split", "base"} & set(step)
        _keys(step, STEP | ({"best"} if best else {"cuts"} | more), "a step")
        need(len(_rows(step["turns"], "turns", 2)) == pairs, "turns of pairs are not complete")
        for ends in step["turns"]:
            for value in ends:
                self.number(value, ANGLE, "turns")
        if best:
            self.multipliers(step["best"], pairs)
            return []
        if "base" in step:
            self.multipliers(step["base"], pairs)
        for body, sign, end, multipliers in _rows(step["cuts"], "cuts", 4):
            self.index(body, bodies, "cuts")
            self.number(sign, 1, "cuts")
            need(type(sign) is int and sign in (1, -1), "a cut has no side")
            self.number(end, ANGLE, "cuts")
            self.multipliers(multipliers, pairs)
        if "split" in step:
            need(isinstance(step["split"], list) and len(step["split"]) == 2, "a split names nothing")
            self.index(step["split"][0], bodies, "splits")
            self.number(step["split"][1], ANGLE, "splits")
        return _rows(step.get("then", []), "proof")

    def multipliers(self, multipliers: Any, pairs: int) -> None:
        need(isinstance(multipliers, list) and len(multipliers) == 3, "multipliers are not complete")
        unit, goal, rows = multipliers
        self.number(unit, FACTOR, "multipliers")
        self.number(goal, FACTOR, "multipliers")
        for p, *whole in _rows(rows, "multipliers", 9):
            self.index(p, pairs, "multipliers")
            for value in whole:
                self.number(value, FACTOR, "multipliers")
                need(type(value) is int, "a multiplier is no whole number of units")


def _keys(value: Any, keys: set[str], what: str) -> None:
    need(isinstance(value, dict), f"{what} has no fields")
    for word, odd in (("lacks", keys - set(value)), ("has a field that does not belong there:", set(value) - keys)):
        need(not odd, f"{what} {word} {_shown(min(odd, key=str, default=''))}")


def _rows(value: Any, where: str, wide: int | None = None) -> list:
    need(isinstance(value, list), f"{where}: this is no list")
    if wide is not None:
        need(all(isinstance(row, list) and len(row) == wide for row in value), f"{where}: a row has not {wide} entries")
    return value


def _refuse(where: str, value: Any, why: str) -> None:
    """Refuse a value; its words are made only here, as there are many values."""
    need(False, f"{where}: {_shown(value)} {why}")


def _shown(value: Any) -> str:
    """A value for a message, on one line and no longer than that."""
    if type(value) is int and abs(value) > 2**63:
        return "a whole number of many digits"
    text = json.dumps(value) if isinstance(value, str | int | float | None) else f"a {type(value).__name__}"
    return text if len(text) <= 60 else f"{text[:50]}..."


def _check_ring(ring: list, hole: bool) -> None:
    """Refuse a ring that bounds nothing or runs the wrong way round: material lies left of every edge."""
    need(len(ring) >= 3, "an outline has fewer than three corners")
    corners = [point(p) for p in ring]
    for k, p in enumerate(ring):
        need(p != ring[k - 1], "an outline has a corner twice")
    area = sum(
        (cross(less(p, corners[0]), less(q, corners[0])) for p, q in itertools.pairwise(corners)),
        start=0 * corners[0][0],
    )
    need(bool(area < 0) if hole else bool(area > 0), "an outline runs the wrong way round")
