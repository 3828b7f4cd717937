"""The same assembly told differently: `python -m benchmarks.invariance COUNT [FIRST]`.

Random assemblies of the families of benchmarks/attack are told once more: shuffled and renamed, mirrored, turned by any angle, moved by
1e6 mm, scaled by 1e-3 to 1e6, and with a part cut into two outlines, one after the other. Values must agree to 1e-6 and verdicts be the
same; a value that is lower than another by more than its proof allows must not be called proven. Prints every assembly that does not
agree, and how many do.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from benchmarks.attack.drawing import Json, Random, turned
from benchmarks.attack.families import MEASURED_FAMILIES, draw

VALUE_TOLERANCE = 1e-6
"""Values agree to this share."""
PROVEN_WITHIN = 1.001
"""A proven value may be exceeded by this factor at most."""
AWAY = 1e6
"""So far are assemblies moved [mm]."""


def shuffled(made: Json, rng: Random) -> Json:
    """Parts in another order and with other names."""
    names = [p["name"] for p in made["parts"]]
    new = dict(zip(names, (f"part {k}" for k in rng.permutation(len(names))), strict=True))
    parts = [made["parts"][k] | {"name": new[names[k]]} for k in rng.permutation(len(names))]
    out = made | {"parts": parts, "pull": [g | {"part": new[g["part"]]} for g in made["pull"]]}
    for key in ("glue", "ignore"):
        if key in made:
            out[key] = [[new[name] for name in group] for group in made[key]]
    return out


def mirrored(made: Json, _: Random) -> Json:
    """The mirror image."""

    def ring(points: list[list[float]]) -> list[list[float]]:
        return [[-x, y] for x, y in reversed(points)]

    parts = [_reshaped(p, ring) | {"at": [-p["at"][0], p["at"][1], -p["at"][2]]} for p in made["parts"]]
    goals = []
    for goal in made["pull"]:
        goal = {k: [-v[0], v[1]] if k in ("direction", "point") else v for k, v in goal.items()}
        if "turn" in goal:
            goal["turn"] = {"cw": "ccw", "ccw": "cw"}[goal["turn"]]
        goals.append(goal)
    return made | {"parts": parts, "pull": goals}


def turned_anyhow(made: Json, rng: Random) -> Json:
    """Turned by any angle."""
    return turned(made, float(rng.uniform(0, 2 * np.pi)))


def moved_away(made: Json, rng: Random) -> Json:
    """Moved far away."""
    angle = rng.uniform(0, 2 * np.pi)
    by = AWAY * np.array([np.cos(angle), np.sin(angle), 0.0])
    parts = [p | {"at": (np.array(p["at"]) + by).tolist()} for p in made["parts"]]
    goals = [g | ({"point": (np.array(g["point"]) + by[:2]).tolist()} if "point" in g else {}) for g in made["pull"]]
    return made | {"parts": parts, "pull": goals}


def scaled(made: Json, rng: Random) -> Json:
    """Larger or smaller."""
    unit = float(10.0 ** rng.uniform(-3, 6))

    def ring(points: list[list[float]]) -> list[list[float]]:
        return (unit * np.array(points)).tolist()

    parts = [_reshaped(p, ring) | {"at": [unit * p["at"][0], unit * p["at"][1], p["at"][2]]} for p in made["parts"]]
    goals = [g | ({"point": [unit * x for x in g["point"]]} if "point" in g else {}) for g in made["pull"]]
    return made | {"parts": parts, "pull": goals, "scaled": unit}


def split(made: Json, _: Random) -> Json:
    """The largest part of one outline cut into two that share a side."""
    sizes = [(shapely.Polygon(p["outline"], p.get("holes")).area if "outline" in p else 0.0) for p in made["parts"]]
    k = int(np.argmax(sizes))
    if not sizes[k]:
        return made
    shape = shapely.Polygon(made["parts"][k]["outline"], made["parts"][k].get("holes"))
    x0, y0, x1, y1 = shape.bounds
    middle = 0.41 * x0 + 0.59 * x1
    halves = [shapely.intersection(shape, shapely.box(*b)) for b in ((x0, y0, middle, y1), (middle, y0, x1, y1))]
    pieces = [p for half in halves for p in shapely.get_parts(half) if p.geom_type == "Polygon" and p.area > 0]
    regions = [
        {
            "outline": [list(c) for c in p.exterior.coords[:-1]],
            "holes": [[list(c) for c in h.coords[:-1]] for h in p.interiors],
        }
        for p in (shapely.orient_polygons(piece) for piece in pieces)
    ]
    plain = {key: value for key, value in made["parts"][k].items() if key not in ("outline", "holes")}
    parts = [*made["parts"][:k], plain | {"outlines": regions}, *made["parts"][k + 1 :]]
    return made | {"parts": parts}


def _reshaped(part: Json, ring: Callable[[list[list[float]]], list[list[float]]]) -> Json:
    """A part with other rings."""

    def region(one: Json) -> Json:
        return {"outline": ring(one["outline"]), "holes": [ring(h) for h in one.get("holes", [])]}

    if "outlines" in part:
        return part | {"outlines": [region(one) for one in part["outlines"]]}
    return part | region(part)


CHANGES = (shuffled, mirrored, turned_anyhow, moved_away, scaled, split)


@dataclass(frozen=True)
class Told:
    """What was answered: the value in units of the first telling; inf where nothing stops the motion."""

    verdict: str
    value: float


def ask(made: Json) -> Told | None:
    """The answer about an assembly; None where it is refused."""
    import wiggleroom as wr

    unit = made.get("scaled", 1.0)
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / "told.json"
        file.write_text(json.dumps({k: v for k, v in made.items() if k != "scaled"}), encoding="utf-8")
        try:
            answer = wr.flex(wr.read(str(file)))
        except wr.InputError:
            return None
    length = all("turn" not in goal for goal in made["pull"])
    value = np.inf if answer.objective is None else answer.objective / (unit if length else 1.0)
    return Told(str(answer.verdict), value)


def differs(one: Told, other: Told) -> str:
    """What two tellings do not agree in; empty where they do."""
    if one.verdict != other.verdict:
        return f"{one.verdict} {one.value:.9g}, {other.verdict} {other.value:.9g}"
    if np.isfinite(one.value) and abs(one.value - other.value) > VALUE_TOLERANCE * max(
        abs(one.value), abs(other.value)
    ):
        return f"{one.value:.9g}, {other.value:.9g}"
    return ""


def main() -> int:
    """Tell assemblies differently; 1 where a lower value is called proven."""
    asked = argparse.ArgumentParser(prog="python -m benchmarks.invariance", description=__doc__.splitlines()[0])
    asked.add_argument("count", type=int, help="so many assemblies")
    asked.add_argument("first", type=int, nargs="?", default=70_000, help="number of the first")
    said = asked.parse_args()
    agree = told = wrong = 0
    began = time.process_time()
    for number in range(said.first, said.first + said.count):
        family, made = draw(number, MEASURED_FAMILIES)
        if made is None:
            continue
        rng = np.random.default_rng([number, 4])
        change = CHANGES[number % len(CHANGES)]
        one, other = ask(made), ask(change(made, rng))
        if one is None or other is None:
            if one is not other:
                print(f"{family}_{number} {change.__name__}: one of them is refused", flush=True)
            continue
        told += 1
        found = differs(one, other)
        agree += not found
        low, high = sorted((one, other), key=lambda t: t.value)
        false = low.verdict == "proven" and high.value > PROVEN_WITHIN * low.value
        wrong += false
        if found:
            print(f"{family}_{number} {change.__name__}: {found}{', and the lower is proven' * false}", flush=True)
    print(
        f"{agree} of {told} agree; {wrong} lower values are called proven; {time.process_time() - began:.0f} s of processor time"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
