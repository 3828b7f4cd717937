"""Bounds of one body in space against an independent search, and forged certificates: `python -m benchmarks.bounds_in_space COUNT FIRST`.

A box with a notch lies loosely in a closed cavity with a post, each drawn at random. The body is moved at random by python-fcl, in small
steps from rest, towards more of what is asked; what it reaches may not exceed the bound. `--forge 200` changes numbers of certificates:
what is still verified for the file must be true, which is so of no bound below the motion found.
"""

from __future__ import annotations

import argparse
import copy
import hashlib
import json
import tempfile
import time
from pathlib import Path

import fcl
import numpy as np
from scipy.spatial.transform import Rotation

import wiggleroom as wr
from wiggleroom.cli.options import QuestionOptions
from wiggleroom.cli.verify_command import assembled_by
from wiggleroom.verify.checker import verify
from wiggleroom.verify.space_claim import spatial_difference

STEPS = 1500
WORK = 20_000.0


def case(seed: int) -> tuple[dict, np.ndarray, np.ndarray]:
    """An assembly file, a direction and a point of the body."""
    rng = np.random.default_rng(seed)
    size = rng.uniform(8, 20, 3).round(1)
    wall, gap = 4.0, round(rng.uniform(0.2, 0.6), 2)
    low, high = np.zeros(3), size
    walls = []
    for axis in range(3):
        for end in (0, 1):
            a, b = low - wall, high + wall
            (b if end == 0 else a)[axis] = (low if end == 0 else high)[axis]
            walls.append([*a, *b])
    post, notch = low.copy(), high.copy()
    axis = int(rng.integers(3))  # the post runs along this axis, in a corner of the cavity
    for k in range(3):
        if k != axis:
            notch[k] = round(size[k] * rng.uniform(0.2, 0.45), 1)
    walls.append([*post, *notch])
    one, other = (k for k in range(3) if k != axis)
    a, b = low.copy(), low.copy()
    a[one] = notch[one]
    b[other] = notch[other]
    body = [[*a, *high], [*b, *high]]
    parts = [
        {"name": "case", "boxes": [list(map(float, w)) for w in walls], "fixed": True},
        {"name": "body", "boxes": [list(map(float, w)) for w in body]},
    ]
    direction = np.eye(3)[rng.integers(3)] * rng.choice([-1, 1])
    point = np.where(rng.random(3) < 0.5, low, high).astype(float)
    return {"format": "wiggleroom/2", "gap": gap, "parts": parts}, direction, point


def boxes_of(part: dict, inward: float) -> list[np.ndarray]:
    """Boxes that fill a part whose faces move inward: of two that overlap, what both share stays whole."""
    every = [np.array(box).reshape(2, 3) for box in part["boxes"]]
    return [np.array([low + inward, high - inward]) for low, high in every]


def reached(content: dict, direction: np.ndarray, point: np.ndarray, seed: int) -> float:
    """The furthest that a random walk of small free steps gets.

    Walls of the case lie in its inside as drawn; only faces to the cavity matter, so each wall moves away from it by half the gap. The body
    shrinks by half the gap all round: two boxes that form an L keep their common corner.
    """
    rng = np.random.default_rng(seed + 1)
    inward = content["gap"] / 2
    manager = fcl.DynamicAABBTreeCollisionManager()
    fixed = []
    for low, high in boxes_of(content["parts"][0], inward):
        fixed.append(fcl.CollisionObject(fcl.Box(*(high - low)), fcl.Transform((low + high) / 2)))
    manager.registerObjects(fixed)
    manager.setup()
    boxes = boxes_of(content["parts"][1], inward)
    middle = np.mean([b.mean(axis=0) for b in boxes], axis=0)
    shapes = [fcl.CollisionObject(fcl.Box(*(high - low))) for low, high in boxes]
    radius = max(np.linalg.norm(b - middle, axis=1).max() for b in boxes)

    def free(u: np.ndarray, R: np.ndarray) -> bool:
        for shape, box in zip(shapes, boxes, strict=True):
            shape.setTransform(fcl.Transform(R, R @ (box.mean(axis=0) - middle) + middle + u))
            data = fcl.CollisionData()
            manager.collide(shape, data, fcl.defaultCollisionCallback)
            if data.result.is_collision:
                return False
        return True

    def value(u: np.ndarray, R: np.ndarray) -> float:
        return float(direction @ (R @ (point - middle) + middle + u - point))

    u, R, best = np.zeros(3), np.eye(3), 0.0
    if not free(u, R):
        return -np.inf
    step = content["gap"] / 2
    for _ in range(STEPS):
        v = u + rng.normal(size=3) * step
        S = Rotation.from_rotvec(rng.normal(size=3) * step / radius).as_matrix() @ R
        if value(v, S) > value(u, R) - 0.02 * step and free(v, S):
            u, R = v, S
            best = max(best, value(u, R))
        else:
            step = max(step * 0.98, content["gap"] * 1e-3)
    return best


def forged(paper: dict, rng: np.random.Generator) -> dict:
    """A certificate with a few numbers changed, or a lower bound."""
    content = copy.deepcopy(paper)
    places: list[tuple[list | dict, int | str]] = []

    def walk(node: object) -> None:
        if isinstance(node, dict):
            for key, below in node.items():
                (places.append((node, key)) if type(below) in (int, float, bool) else walk(below))
        elif isinstance(node, list):
            for key, below in enumerate(node):
                (places.append((node, key)) if type(below) in (int, float, bool) else walk(below))

    walk(content)
    for _ in range(int(rng.integers(1, 4))):
        where, key = places[rng.integers(len(places))]
        old = where[key]
        if isinstance(old, bool):
            where[key] = not old
        elif isinstance(old, int):
            where[key] = max(old + int(rng.integers(-2, 3)), 0)
        else:
            where[key] = float(old * rng.uniform(0.5, 1.5) + rng.normal() * 0.1)
    if rng.random() < 0.7:
        content["at_most"] = float(paper["at_most"] * rng.uniform(0.3, 0.98))
    rest = json.dumps({k: v for k, v in content.items() if k != "sha256"})
    return content | {"sha256": hashlib.sha256(rest.encode()).hexdigest()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int)
    parser.add_argument("first", type=int, nargs="?", default=0)
    parser.add_argument("--forge", type=int, default=0)
    given = parser.parse_args()
    below, bounded, within, seconds, accepted, tried, refused = 0, 0, 0, [], 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(given.first, given.first + given.count):
            content, direction, point = case(seed)
            file = Path(folder) / "case.json"
            pull = {"part": "body", "direction": direction.tolist(), "point": point.tolist()}
            file.write_text(json.dumps(content | {"pull": [pull]}))
            began = time.process_time()
            answer = wr.flex(wr.read(file), wr.Pull("body", tuple(direction), tuple(point)), search=0)
            answer = wr.prove(answer, 0.01, work=WORK, certify=True)
            seconds.append(time.process_time() - began)
            got = reached(content, direction, point, seed)
            bound = answer.bound.at_most if answer.bound else None
            if bound is not None:
                bounded += 1
                within += bound <= 1.01 * answer.objective
                below += got > bound + 1e-9
            print(seed, f"found {answer.objective:.5f} search {got:.5f}", "at most", bound, flush=True)
            paper = answer.bound.certificate if answer.bound else None
            refused += paper is not None and not verify(json.loads(json.dumps(paper))).proven
            rng = np.random.default_rng(seed)
            share = -(-given.forge // given.count) if paper else 0
            for _ in range(min(share, given.forge - tried)):
                tried += 1
                found = verify(forged(json.loads(json.dumps(paper)), rng))
                if found.proven and not spatial_difference(found.claim, assembled_by(str(file), QuestionOptions())):
                    wrong = found.at_most < max(got, answer.objective) - 1e-9
                    accepted += wrong
                    print("   a changed certificate is verified:", found.at_most, "WRONG" if wrong else "and true")
    print(
        f"{bounded} of {given.count} bounded, {within} within 1 %, {below} below the search, {refused} not verified; {accepted} of "
        f"{tried} forgeries accepted; median {np.median(seconds):.2f} s, most {max(seconds):.2f} s"
    )


if __name__ == "__main__":
    main()
