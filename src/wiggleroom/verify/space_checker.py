"""Whether a certificate about one body that moves in space proves what it says.

Read this file, `ball_arithmetic`, `work_limit` and `check_unchanged`: that is all. It rests on python-flint (ball arithmetic), exact
fractions, and on this: a body is rigid, and a point of its material is never inside the material of another body.

A pose is (u, a): the body turns by the quaternion (1, a) / |(1, a)| about its origin, then moves by u. The proof is a tree that divides a
box of poses. Its steps cut off what is not free, by multipliers of rows; a row says that a material point of one body lies beyond one
face of a convex piece of the other, because all other faces have it behind them in the whole box. A path from rest goes from a leaf to
leaves that share a pose with it. So no leaf that is reached may share a pose with one that is not, or meet the border of the box.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from flint import arb

from wiggleroom.verify.ball_arithmetic import exact, need
from wiggleroom.verify.certificate_structure import check_unchanged
from wiggleroom.verify.work_limit import WorkLimit

FORMAT = "wiggleroom.certificate/5"
LENGTH = 1e9
"""Largest number that is read."""
SMALL = 1e-100
"""Smallest that is not zero: fractions of smaller ones get long."""
NUMBERS = 10
"""Each entry of a file counts as so many numbers of a plane certificate: a row names a piece, and all faces of that are looked at."""
DOT, ANGLE, CLIP, ROW, BOXES = 20, 1000, 2500, 5600, 75
"""Steps of work that are counted for a product of vectors, a solid angle, a triangle before a face, a row, and two boxes."""
DEEPEST = 400
"""Most steps of a proof that may follow each other."""

TOP = {
    "format", "dimension", "gap", "at_most", "origin", "free", "goal", "parts", "pieces", "points", "box", "proof", "sha256",
}  # fmt: skip

Vector = tuple[arb, arb, arb]


@dataclass(frozen=True)
class SpatialClaim:
    """What a certificate claims of a motion in space.

    Parameters
    ----------
    at_most : float [mm], of a turn [rad]
    gap : float [mm]
    part : str
        The part that is asked about.
    turn : bool
    direction : (3,) tuple of float
    point : (3,) tuple of float [mm] or None
    weight : float
    fixed, moving : tuple of str
        Names of parts that stand, and of those that move as one.
    free : (6,) tuple of bool
        Which of x, y, z, rx, ry, rz may change.
    origin : (3,) tuple of float [mm]
        The point of the body that these are about.
    surfaces : dict
        Vertices [mm] and faces of each part, at rest.
    """

    at_most: float
    gap: float
    part: str
    turn: bool
    direction: tuple[float, ...]
    point: tuple[float, ...] | None
    weight: float
    fixed: tuple[str, ...]
    moving: tuple[str, ...]
    free: tuple[bool, ...]
    origin: tuple[float, ...]
    surfaces: dict[str, tuple[list, list]] = field(repr=False)


@dataclass(frozen=True)
class SpatialCounts:
    """How much there was to check."""

    pieces: int
    points: int
    boxes: int
    programs: int


def in_space(content: Any) -> bool:
    """Whether a certificate is about a motion in space."""
    return isinstance(content, dict) and content.get("format") == FORMAT


def verify_spatial(content: dict[str, Any]) -> tuple[SpatialClaim, SpatialCounts]:
    """Check a certificate; the precision of balls is set by whoever calls.

    Raises
    ------
    Refused
        With the first reason why nothing is proven.
    """
    _check_form(content)
    check_unchanged(content)
    proof = _Proof(content)
    proof.walk(content["proof"])
    goal = content["goal"]
    best = max(proof.bounds)
    proven = exact(goal["weight"]) * (2 * best.atan() if "turn" in goal else best)
    need(
        bool(proven <= exact(content["at_most"])),
        f"the multipliers prove {float(proven):.9g} only, not {content['at_most']:.9g}",
    )
    parts = content["parts"]
    claim = SpatialClaim(
        float(content["at_most"]),
        float(content["gap"]),
        goal["part"],
        "turn" in goal,
        tuple(map(float, goal["turn" if "turn" in goal else "pull"])),
        tuple(map(float, goal["point"])) if "point" in goal else None,
        float(goal["weight"]),
        tuple(p["name"] for p in parts if p["fixed"]),
        tuple(p["name"] for p in parts if not p["fixed"]),
        tuple(content["free"]),
        tuple(map(float, content["origin"])),
        {p["name"]: (p["vertices"], p["faces"]) for p in parts},
    )
    return claim, SpatialCounts(len(content["pieces"]), len(content["points"]), len(proof.bounds), proof.programs)


# what a file may look like


def _number(value: Any, most: float = LENGTH) -> None:
    fits = type(value) is float or (type(value) is int and abs(value) <= 2**53)
    fits = fits and math.isfinite(value) and (value == 0 or SMALL <= abs(value) <= most)
    need(fits, f"{str(value)[:50]!r} is no number that can be used")


def _numbers(values: Any, count: int) -> None:
    need(isinstance(values, list) and len(values) == count, f"a list of {count} numbers is not one")
    for value in values:
        _number(value)


def _entries(content: Any) -> int:
    """How many lists, objects and values a file has."""
    count, todo = 0, [content]
    while todo:
        node = todo.pop()
        count += 1
        if isinstance(node, dict | list):
            todo += node.values() if isinstance(node, dict) else node
    return count


def _index(value: Any, count: int) -> None:
    need(type(value) is int and 0 <= value < count, f"{str(value)[:50]!r} names nothing")


def _list(value: Any) -> list:
    need(isinstance(value, list), "a list is missing")
    return value


def _keys(value: Any, *allowed: set[str]) -> None:
    need(
        isinstance(value, dict) and set(value) in allowed, "an entry lacks fields, or has some that do not belong there"
    )


def _check_form(content: dict[str, Any]) -> None:
    _keys(content, TOP)
    need(content["format"] == FORMAT and content["dimension"] == 3, f'the format is not "{FORMAT}"')
    _number(content["gap"])
    need(content["gap"] >= 0, "the gap is negative")
    _number(content["at_most"])
    _numbers(content["origin"], 3)
    free = _list(content["free"])
    need(len(free) == 6 and all(isinstance(f, bool) for f in free), "it is not said which freedoms there are")
    names = []
    for part in _list(content["parts"]):
        _keys(part, {"name", "fixed", "vertices", "faces"})
        need(isinstance(part["name"], str) and isinstance(part["fixed"], bool), "a part has no name or no role")
        names.append(part["name"])
        for vertex in _list(part["vertices"]):
            _numbers(vertex, 3)
        for face in _list(part["faces"]):
            need(isinstance(face, list) and len(face) == 3, "a face is no triangle")
            for corner in face:
                _index(corner, len(part["vertices"]))
    need(len(set(names)) == len(names), "two parts have one name")
    moving = {p["name"] for p in content["parts"] if not p["fixed"]}
    need(bool(moving) and len(moving) < len(names), "nothing moves, or nothing stands")
    goal = content["goal"]
    _keys(goal, {"part", "turn", "weight"}, {"part", "pull", "point", "weight"})
    need(goal["part"] in moving, "what is asked is not about the body that moves")
    _number(goal["weight"])
    need(goal["weight"] > 0, "the weight is not positive")
    for key in ("turn", "pull", "point"):
        if key in goal:
            _numbers(goal[key], 3)
    need(any(goal.get("turn") or goal.get("pull")), "a direction is missing")
    if "turn" in goal:
        need(abs(math.hypot(*goal["turn"]) - 1) < 1e-12, "the direction of a turn is no unit vector")
    for piece in _list(content["pieces"]):
        _keys(piece, {"part", "inside", "faces"})
        _index(piece["part"], len(names))
        _numbers(piece["inside"], 3)
        need(len(_list(piece["faces"])) >= 4, "a piece has fewer than four faces")
        for face in piece["faces"]:
            _numbers(face, 4)
    for point in _list(content["points"]):
        _numbers(point, 4)
        _index(point[0], len(content["pieces"]))
    box = _list(content["box"])
    need(len(box) == 2, "a box has two corners")
    for corner in box:
        _numbers(corner, 6)
    for low, high, moves in zip(*box, free, strict=True):
        need(low < 0 < high if moves else low == 0 == high, "the box of poses does not fit to rest and to the freedoms")


# solids


def _vector(values: list) -> Vector:
    x, y, z = values
    return exact(x), exact(y), exact(z)


def _dot(p: Vector, q: Vector) -> arb:
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


def _length(p: Vector) -> arb:
    return _dot(p, p).sqrt()


def _less(p: Vector, q: Vector) -> Vector:
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def _cross(p: Vector, q: Vector) -> Vector:
    return p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]


def _check_closed(part: dict[str, Any]) -> None:
    """Refuse a surface in which a side of a triangle has no other that runs back along it."""
    count: dict[tuple[int, int], int] = {}
    for a, b, c in part["faces"]:
        for one, two in ((a, b), (b, c), (c, a)):
            count[one, two] = count.get((one, two), 0) + 1
    closed = all(count.get((two, one), 0) == times for (one, two), times in count.items())
    need(closed, f"the surface of {part['name'][:50]!r} is not closed")


def _check_inside(piece: dict[str, Any], part: dict[str, Any], work: WorkLimit) -> None:
    """Refuse a piece that is not inside the solid of its part: no triangle meets it, and one of its points is inside."""
    work.spend(DOT * len(piece["faces"]) * len(part["vertices"]) + ANGLE * len(part["faces"]))
    inside = _vector(piece["inside"])
    planes = [(_vector(face[:3]), exact(face[3])) for face in piece["faces"]]
    need(all(bool(_dot(n, inside) < h) for n, h in planes), "a piece does not contain the point that it should")
    vertices = [_vector(v) for v in part["vertices"]]
    beyond = [[bool(_dot(n, v) > h) for v in vertices] for n, h in planes]
    angle = arb(0)
    for corners in part["faces"]:
        if not any(all(side[k] for k in corners) for side in beyond):
            work.spend(CLIP * len(piece["faces"]))
            triangle = [[Fraction(x) for x in part["vertices"][k]] for k in corners]
            need(not _meets(triangle, piece["faces"]), f"a piece of {part['name'][:50]!r} is not inside it")
        angle += _solid_angle(*(_less(vertices[k], inside) for k in corners))
    need(bool(angle > 2 * arb.pi()), f"a piece of {part['name'][:50]!r} is outside it")


def _meets(polygon: list[list[Fraction]], faces: list[list[float]]) -> bool:
    """Whether a triangle has a point in a closed polytope, exactly."""
    for *normal, offset in faces:
        n, h = [Fraction(x) for x in normal], Fraction(offset)
        side = [sum((x * y for x, y in zip(n, p, strict=True)), start=-h) for p in polygon]
        kept: list[list[Fraction]] = []
        for k, p in enumerate(polygon):
            before, now = side[k - 1], side[k]
            if (before < 0 < now) or (now < 0 < before):
                t = before / (before - now)
                kept.append([x + t * (y - x) for x, y in zip(polygon[k - 1], p, strict=True)])
            if now <= 0:
                kept.append(p)
        if not kept:
            return False
        polygon = kept
    return True


def _solid_angle(p: Vector, q: Vector, r: Vector) -> arb:
    """Signed solid angle of a triangle seen from the origin, by Van Oosterom and Strackee (1983)."""
    a, b, c = (_dot(v, v).sqrt() for v in (p, q, r))
    volume = _dot(p, _cross(q, r))
    under = a * b * c + _dot(p, q) * c + _dot(q, r) * a + _dot(r, p) * b
    return 2 * arb.atan2(volume, under)


# poses

Row = tuple[arb, list[arb]]
"""Constant and slopes (6) about the middle of a box."""


class _Boxed:
    """A box of poses, and what holds in it."""

    def __init__(self, low: list[float], high: list[float]) -> None:
        self.low, self.high = low, high
        ends = [(exact(one), exact(two)) for one, two in zip(low, high, strict=True)]
        self.middle = [(one + two) / 2 for one, two in ends]
        self.half = [(two - one) / 2 for one, two in ends]
        x, y, z = self.middle[3:]
        xx, yy, zz = x * x, y * y, z * z
        self.scale = 1 + xx + yy + zz
        self.turned = (
            (1 + xx - yy - zz, 2 * (x * y - z), 2 * (x * z + y)),
            (2 * (x * y + z), 1 - xx + yy - zz, 2 * (y * z - x)),
            (2 * (x * z - y), 2 * (y * z + x), 1 - xx - yy + zz),
        )
        self.square = sum((d * d for d in self.half[3:]), start=arb(0))
        smallest = arb(1)
        for m, d in zip(self.middle[3:], self.half[3:], strict=True):
            least = abs(m) - d
            if least > 0:
                smallest += least * least
        self.smallest = smallest

    def rotated(self, n: Vector, r: Vector) -> tuple[arb, list[arb], arb, arb]:
        """N . R(a) r about the middle: value, slopes, and by how much it is less and more than these say at most."""
        m, d = self.middle[3:], self.half[3:]
        image = [_dot(row, r) for row in self.turned]
        value = sum((x * y for x, y in zip(n, image, strict=True)), start=arb(0)) / self.scale
        along, nm, rm = _dot(n, r), _dot(n, (m[0], m[1], m[2])), _dot(r, (m[0], m[1], m[2]))
        axis = _cross(r, n)
        slopes = [
            (2 * axis[k] + 2 * (n[k] * rm + r[k] * nm) - 2 * m[k] * along - 2 * m[k] * value) / self.scale
            for k in range(3)
        ]
        less = more = self.square * sum((abs(g) * e for g, e in zip(slopes, d, strict=True)), start=arb(0))
        zero = arb(0)
        for i in range(3):
            for j in range(i + 1):
                bend = n[i] * r[j] + n[j] * r[i] - m[i] * slopes[j] - m[j] * slopes[i]
                if i == j:
                    bend -= along + value
                    more += zero.max(bend) * d[i] * d[i]
                    less += zero.max(-bend) * d[i] * d[i]
                else:
                    both = 2 * abs(bend) * d[i] * d[j]
                    more, less = more + both, less + both
        return value, slopes, less / self.smallest, more / self.smallest

    def place(self, moves: bool, point: Vector) -> tuple[Vector, arb]:
        """Where a point is, in the frame of the pieces of the other body, at the middle; and how far from there it may be in the box.

        Quaternions (1, a) of length 1 or more differ by an angle of at most |d|, so the body turns by at most 2 |d| from the middle.
        """
        u, rows = (self.middle[0], self.middle[1], self.middle[2]), self.turned
        z = point if moves else _less(point, u)
        frame = rows if moves else tuple(zip(*rows, strict=True))
        x, y, w = (_dot((a, b, c), z) / self.scale for a, b, c in frame)
        shift = _length((self.half[0], self.half[1], self.half[2]))
        return (x + u[0], y + u[1], w + u[2]) if moves else (x, y, w), 2 * self.square.sqrt() * _length(z) + shift

    def outwards(self, moves: bool, point: Vector, n: Vector, h: arb) -> tuple[Row, arb]:
        """How far a point is beyond a face, as a row that is nowhere less than it, and the most that it is in the box."""
        u, half = self.middle[:3], self.half[:3]
        if moves:
            value, turn, _, wrong = self.rotated(n, point)
            row = value + _dot(n, (u[0], u[1], u[2])) - h + wrong, [*n, *turn]
        else:
            z = _less(point, (u[0], u[1], u[2]))
            value, turn, _, wrong = self.rotated(z, n)
            shift = []
            for k in range(3):
                axis = (arb(k == 0), arb(k == 1), arb(k == 2))
                there, slopes, down, up = self.rotated(axis, n)
                shift.append(-there)
                swing = sum((abs(s) * e for s, e in zip(slopes, self.half[3:], strict=True)), start=arb(0))
                wrong += half[k] * (down.max(up) + swing)
            row = value - h + wrong, [*shift, *turn]
        most = row[0] + sum((abs(s) * e for s, e in zip(row[1], self.half, strict=True)), start=arb(0))
        return row, most


class _Proof:
    """The solids of a certificate, and the walk through its tree."""

    def __init__(self, content: dict[str, Any]) -> None:
        self.free = content["free"]
        self.work = WorkLimit(NUMBERS * _entries(content))
        origin = _vector(content["origin"])
        parts, pieces = content["parts"], content["pieces"]
        for part in parts:
            _check_closed(part)
        for piece in pieces:
            _check_inside(piece, parts[piece["part"]], self.work)
        self.moves = [not parts[piece["part"]]["fixed"] for piece in pieces]
        self.planes: list[list[tuple[Vector, arb]]] = []
        for piece in pieces:
            faces = [(_vector(face[:3]), exact(face[3])) for face in piece["faces"]]
            self.planes.append([(n, h - _dot(n, origin)) for n, h in faces])
        self.points: list[tuple[bool, Vector]] = []
        for k, *at in content["points"]:
            place = _less(_vector(at), origin)
            need(all(bool(_dot(n, place) <= h) for n, h in self.planes[k]), "a point is not in its piece")
            self.points.append((self.moves[k], place))
        goal = content["goal"]
        self.turn = _vector(goal["turn"]) if "turn" in goal else None
        self.pull = _vector(goal["pull"]) if "pull" in goal else None
        self.arm = _less(_vector(goal["point"]), origin) if "point" in goal else None
        self.domain = [list(map(float, corner)) for corner in content["box"]]
        self.bounds: list[arb] = []
        self.programs = 0

    def walk(self, root: Any) -> None:
        """Check all steps, and that what is reached is closed."""
        reached: list[tuple[list[float], list[float]]] = []
        open_: list[tuple[list[float], list[float]]] = []
        todo = [(root, *self.domain, 0)]
        while todo:
            step, low, high, depth = todo.pop()
            need(isinstance(step, dict), "a step of the proof is none")
            need(depth < DEEPEST, "the proof is nested too deeply")
            if set(step) == {"open"}:
                need(step["open"] is True, "a leaf is neither open nor reached")
                open_.append((low, high))
            elif set(step) == {"split", "then"}:
                need(isinstance(step["split"], list) and len(step["split"]) == 2, "a split has no place")
                axis, at = step["split"]
                _index(axis, 6)
                _number(at)
                need(low[axis] <= at <= high[axis] and len(_list(step["then"])) == 2, "a split is not inside its box")
                less, more = list(high), list(low)
                less[axis] = more[axis] = float(at)
                todo += [(step["then"][0], low, less, depth + 1), (step["then"][1], more, high, depth + 1)]
            elif set(step) == {"rows", "best"}:
                box = _Boxed(low, high)
                self.bounds.append(self._most(box, self._rows(box, step["rows"]), step["best"], self._goal(box)))
                reached.append((low, high))
            else:
                need(set(step) in ({"rows", "cuts"}, {"rows", "cuts", "then"}), "a step of the proof is none")
                low, high = self._cut(step, low, high)
                if any(one > two for one, two in zip(low, high, strict=True)):
                    need("then" not in step, "something follows where no pose is left")
                    continue
                need("then" in step and len(_list(step["then"])) == 1, "nothing follows the cuts of a step")
                todo.append((step["then"][0], low, high, depth + 1))
        self.work.spend(BOXES * len(reached) * (len(open_) + 1))
        need(any(_share(box, ([0.0] * 6, [0.0] * 6)) for box in reached), "rest is in no box that is reached")
        for low, high in reached:
            for k in range(6):
                inner = self.domain[0][k] < low[k] and high[k] < self.domain[1][k]
                need(inner or not self.free[k], "what is reached meets the border of the box of poses")
            need(
                not any(_share((low, high), other) for other in open_),
                "what is reached goes on into a box that is left open",
            )

    def _rows(self, box: _Boxed, rows: Any) -> list[Row]:
        """Rows of a step, each of which holds in the box."""
        found = []
        for row in _list(rows):
            need(isinstance(row, list) and len(row) == 3, "a row does not name a point, a piece and a face")
            _index(row[0], len(self.points))
            _index(row[1], len(self.planes))
            moves, point = self.points[row[0]]
            need(moves != self.moves[row[1]], "a row is about a single body")
            planes = self.planes[row[1]]
            _index(row[2], len(planes))
            self.work.spend(ROW + DOT * len(planes))
            place, away = box.place(moves, point)
            found.append(box.outwards(moves, point, *planes[row[2]])[0])
            for k, (n, h) in enumerate(planes):
                if k != row[2] and not _dot(n, place) - h + away * _length(n) < 0:
                    self.work.spend(ROW)
                    most = box.outwards(moves, point, n, h)[1]
                    need(bool(most < 0), "a point may be beyond another face than that of its row")
        return found

    def _goal(self, box: _Boxed) -> Row:
        """What is asked, as a row that is nowhere less."""
        m = box.middle
        if self.turn is not None:
            return _dot(self.turn, (m[3], m[4], m[5])), [arb(0), arb(0), arb(0), *self.turn]
        assert self.pull is not None
        assert self.arm is not None
        value, turn, _, wrong = box.rotated(self.pull, self.arm)
        return value + wrong + _dot(self.pull, _less((m[0], m[1], m[2]), self.arm)), [*self.pull, *turn]

    def _most(self, box: _Boxed, rows: list[Row], multipliers: Any, asked: Row) -> arb:
        """What multipliers prove: the most that a row is at a free pose in the box."""
        self.programs += 1
        constant, slopes = asked[0], list(asked[1])
        for entry in _list(multipliers):
            need(isinstance(entry, list) and len(entry) == 2, "a multiplier names no row")
            _index(entry[0], len(rows))
            _number(entry[1])
            need(entry[1] >= 0, "a multiplier is negative")
            y, (first, more) = exact(entry[1]), rows[entry[0]]
            constant += y * first
            slopes = [s + y * t for s, t in zip(slopes, more, strict=True)]
        return (constant + sum((abs(s) * d for s, d in zip(slopes, box.half, strict=True)), start=arb(0))).upper()

    def _cut(self, step: dict[str, Any], low: list[float], high: list[float]) -> tuple[list[float], list[float]]:
        """Ends of a box after the cuts of a step."""
        box = _Boxed(low, high)
        rows = self._rows(box, step["rows"])
        low, high = list(low), list(high)
        for entry in _list(step["cuts"]):
            need(isinstance(entry, list) and len(entry) == 4, "a cut is none")
            axis, sign, end, multipliers = entry
            _index(axis, 6)
            _number(end)
            need(type(sign) is int and sign in (1, -1), "a cut has no side")
            slopes = [arb(sign) if k == axis else arb(0) for k in range(6)]
            most = self._most(box, rows, multipliers, (sign * box.middle[axis], slopes))
            need(bool(most <= sign * exact(end)), "multipliers do not prove a cut")
            if sign > 0:
                high[axis] = min(high[axis], float(end))
            else:
                low[axis] = max(low[axis], float(end))
        return low, high


def _share(one: tuple[list[float], list[float]], other: tuple[list[float], list[float]]) -> bool:
    """Whether two boxes have a pose in common."""
    return all(a <= d and c <= b for a, b, c, d in zip(*one, *other, strict=True))
