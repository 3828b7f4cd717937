"""Public voxel puzzles taken apart from the command line: `python -m benchmarks.voxel_puzzles RESULTS FILE...`.

The fewest moves to the first removal are compared with the level that is published: in the name of a file (`_L27`) of High-LevelPuzzle, in
the stored disassembly of a project of BurrTools. `--sample 20` takes so many stored solutions of each file, from a fixed seed. `--as stl`
writes every puzzle as meshes first, with the gap drawn into it and turned anywhere. Every plan is replayed by the collision library
python-fcl on shapes of its own, made from the cells alone. One line of JSON a puzzle goes to RESULTS, and puzzles that have one there are
not asked again; `--table` prints what it holds.
"""

from __future__ import annotations

import argparse
import itertools
import json
import re
import resource
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from benchmarks import spatial_overlaps
from wiggleroom.drawing.model import Drawing
from wiggleroom.drawing.readers.voxel_puzzle import CELL, GAP, _unpacked, read_puzzle
from wiggleroom.drawing.readers.xmltree import parse_xml

SECONDS = 600
"""After so much time, not processor time, a puzzle is given up: a busy machine must not decide."""
MOMENTS = 9
"""Moments at which each straight piece of a path is judged."""


def cells_of(drawing: Drawing) -> list[set]:
    found = []
    for part in drawing.parts:
        boxes = (part.solid.boxes / CELL).round().astype(int)
        found.append({v for low, high in boxes.tolist() for v in itertools.product(*map(range, low, high))})
    return found


def shrunk(cells: set, e: float) -> list[np.ndarray]:
    """Boxes whose union is a set of unit cubes with every face e further inside: all largest boxes in it, shrunk.

    A cube of side 2 e about a point meets at most 2 x 2 x 2 cells; if it lies in the set, so does one of these boxes round it.
    """
    low = np.array(sorted(cells)).min(axis=0) - 1
    solid = np.zeros(np.array(sorted(cells)).max(axis=0) - low + 2, dtype=bool)
    solid[tuple((np.array(sorted(cells)) - low).T)] = True
    found = set()
    for v in sorted(cells):
        for span in itertools.product((1, 2), repeat=3):
            begin = [int(x) for x in np.array(v) - low]
            end = [a + s for a, s in zip(begin, span, strict=True)]
            if not solid[tuple(map(slice, begin, end))].all():
                continue
            for axis in range(3):
                for ends, step in ((begin, -1), (end, 1)):
                    while True:
                        ends[axis] += step
                        if not solid[tuple(map(slice, begin, end))].all():
                            ends[axis] -= step
                            break
            found.add((tuple(begin), tuple(end)))
    return [spatial_overlaps.box(np.array(a) + low + e, np.array(b) + low - e) for a, b in sorted(found)]


def written(drawing: Drawing, kind: str, folder: Path, seed: int) -> tuple[Path, Rotation]:
    """The puzzle as a file for the command, and how it is turned."""
    R = Rotation.identity() if kind == "boxes" else Rotation.random(random_state=seed)
    parts = []
    for k, (part, cells) in enumerate(zip(drawing.parts, cells_of(drawing), strict=True)):
        if kind == "boxes":
            parts.append({"name": part.name, "boxes": part.solid.boxes.reshape(-1, 6).tolist()})
            continue
        hulls = [trimesh.convex.convex_hull(c) for c in shrunk(cells, GAP / CELL / 2)]
        mesh = trimesh.boolean.union(hulls, engine="manifold")
        mesh.vertices = R.apply(CELL * mesh.vertices)
        mesh.export(folder / f"{k}.{kind}")
        parts.append({"name": part.name, "mesh": f"{k}.{kind}"})
    file = folder / "puzzle.json"
    gap = GAP if kind == "boxes" else 0.0
    file.write_text(json.dumps({"format": "wiggleroom/2", "unit": "mm", "gap": gap, "parts": parts}))
    return file, R


def asked(file: Path, seconds: float) -> dict:
    """What the command says, and its processor time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    out = file.parent / "plan.json"
    command = [
        str(Path(sys.executable).parent / "wiggleroom"),
        "plan",
        str(file),
        "--json",
        str(out),
        "--time",
        str(seconds),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if not out.exists():
        return {"verdict": "refused", "said": done.stderr.strip()[-200:], "cpu": round(used, 2)}
    return json.loads(out.read_text()) | {"cpu": round(used, 2)}


def deepest(drawing: Drawing, plan: dict, R: Rotation) -> float:
    """Deepest overlap [mm] on the way of a plan, by shapes made from the cells."""
    shapes = [[CELL * c for c in shrunk(cells, GAP / CELL / 2)] for cells in cells_of(drawing)]
    names = [part.name for part in drawing.parts]
    there, worst = list(range(len(names))), 0.0
    rest = np.zeros((len(names), 3))
    for step in plan["steps"]:
        judge = spatial_overlaps.Judge([shapes[k] for k in there], rest[there], [False] * len(there))
        places = [
            np.array([R.inv().apply(moment[n]["move"] if n in moment else now[k]) for k, n in enumerate(names)])
            for now in [rest]
            for moment in step["path"]
        ]
        for one, other in itertools.pairwise(places):
            for share in np.linspace(0, 1, MOMENTS):
                motion = np.zeros((len(there), 6))
                motion[:, :3] = (one + share * (other - one))[there]
                worst = max(worst, judge.depth(motion))
        there = [k for k in there if names[k] not in step["leaves"]]
    return worst


def published(path: Path, solution: int) -> int | None:
    """Moves to the first removal that the file tells of."""
    if path.suffix == ".puz":
        found = re.search(r"_L(\d+)", path.name)
        return int(found[1]) if found else None
    root = parse_xml(_unpacked(path))
    problems = next(c for c in root.children if c.tag == "problems").children
    for problem in problems:
        solutions = [s for child in problem.children if child.tag == "solutions" for s in child.children]
        if solutions:
            for child in solutions[solution].children:
                if child.tag == "separationInfo":
                    return int(child.text.split()[0]) - 1
                if child.tag == "separation":
                    return sum(state.tag == "state" for state in child.children) - 1
    return None


def jobs(path: Path, sample: int) -> list[int]:
    """Numbers of stored solutions of the first solved problem to look at."""
    if path.suffix == ".puz" or not sample:
        return [0]
    first = next(text for text in _unpacked(path).text.split("</problem>") if "<assembly>" in text)
    count = first.count("<assembly>")
    return sorted(np.random.default_rng(1).permutation(count)[:sample].tolist())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path)
    parser.add_argument("files", type=Path, nargs="*")
    parser.add_argument("--sample", type=int, default=0)
    parser.add_argument("--as", dest="kind", choices=["boxes", "stl", "obj"], default="boxes")
    parser.add_argument("--table", action="store_true")
    given = parser.parse_intermixed_args()
    lines = given.results.read_text().splitlines() if given.results.exists() else []
    known = {(line["file"], line["solution"], line["kind"]): line for line in map(json.loads, lines)}
    for path in given.files:
        for solution in jobs(path, given.sample):
            if (path.name, solution, given.kind) in known:
                continue
            drawing = read_puzzle(path, solution=solution)
            with tempfile.TemporaryDirectory() as folder:
                file, R = written(drawing, given.kind, Path(folder), solution)
                plan = asked(file, SECONDS)
            steps = plan.get("steps", [])
            line = {
                "file": path.name,
                "solution": solution,
                "kind": given.kind,
                "published": published(path, solution),
                "verdict": plan["verdict"],
                "level": plan.get("level", []),
                "first": next((step["leaves"] for step in steps if step["leaves"]), []),
                "remains": plan.get("remains", []),
                "said": plan.get("said", ""),
                "cpu": plan["cpu"],
                "deepest": deepest(drawing, plan, R) if steps else 0.0,
            }
            known[path.name, solution, given.kind] = line
            with given.results.open("a") as out:
                out.write(json.dumps(line) + "\n")
            print(json.dumps(line), flush=True)
    if given.table:
        table(list(known.values()))


def table(lines: list[dict]) -> None:
    groups = defaultdict(list)
    for line in lines:
        groups[line["file"] if line["file"].endswith(".xmpuzzle") else "*.puz", line["kind"]].append(line)
    print("| puzzles | as | come apart | level as published | unknown | replayed free | processor time |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for (name, kind), some in sorted(groups.items()):
        apart = [x for x in some if x["verdict"] == "comes apart"]
        said = [x for x in some if x["published"] is not None]
        same = sum(bool(x["level"]) and x["level"][0] == x["published"] for x in said)
        free = sum(x["deepest"] < spatial_overlaps.SHALLOW for x in apart)
        seconds = sorted(x["cpu"] for x in some)
        print(
            f"| {name} | {kind} | {len(apart)} of {len(some)} | {same} of {len(said)} | "
            f"{sum(x['verdict'] == 'unknown' for x in some)} | {free} of {len(apart)} | "
            f"median {seconds[len(seconds) // 2]:.1f} s, most {seconds[-1]:.1f} s |"
        )


if __name__ == "__main__":
    main()
