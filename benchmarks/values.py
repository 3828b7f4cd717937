"""What some assemblies of all kinds are worth, and the work that takes: `python -m benchmarks.values [--keep FILE] [--against FILE]`.

Answers of an earlier version, kept in a file with `--keep`, stand beside those of today with `--against`: no value may fall by
more than 1e-4 of itself, and assemblies of up to 50 parts may not cost more. Processor time is that of the second of two questions
in one process.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path

import benchmarks.scale  # knows the joint "arrow"  # noqa: F401
import wiggleroom as wr
from wiggleroom.assembly import patterns
from wiggleroom.assembly.assembly import Assembly

ROOT = Path(__file__).parents[1] / "examples"
LOSS = 1e-4


def _drawing(name: str, gap: float, fixed: str, pulled: str) -> Assembly:
    return wr.read(ROOT / "drawings" / name, gap=gap, fix=[fixed], goals=[wr.Pull(pulled, (1, 0))])


CASES: dict[str, Callable[[], Assembly]] = {
    "chain 10 swallowtail 0.03": lambda: patterns.chain(10, "swallowtail", 0.03),
    "grid 4 x 4 tee 0.02": lambda: patterns.grid(4, 4, "tee", 0.02),
    "grid 6 x 5 swallowtail 0.02": lambda: patterns.grid(6, 5, "swallowtail", 0.02),
    "grid 7 x 7 dovetail 0.01": lambda: patterns.grid(7, 7, "dovetail", 0.01),
    "jigsaw 5 x 4 0.02": lambda: patterns.jigsaw(5, 4, 0.02),
    "jigsaw 7 x 7 0.01": lambda: patterns.jigsaw(7, 7, 0.01),
    "jointpanel_4x4.svg": lambda: _drawing("jointpanel_4x4.svg", 0.2, "p-0", "p-15"),
    "pyjigsaw_4x5.svg": lambda: _drawing("pyjigsaw_4x5.svg", 1.0, "p1", "p20"),
    "frame 14 x 16 tee 0.01": lambda: patterns.frame(14, 16, "tee", 0.01),
    "chain 200 swallowtail 0.01": lambda: patterns.chain(200, "swallowtail", 0.01),
    "grid 10 x 10 tee 0.01": lambda: patterns.grid(10, 10, "tee", 0.01),
    "grid 13 x 12 tee 0.02": lambda: patterns.grid(13, 12, "tee", 0.02),
    "grid 14 x 13 tee 0.01": lambda: patterns.grid(14, 13, "tee", 0.01),
    "grid 12 x 12 swallowtail 0.02": lambda: patterns.grid(12, 12, "swallowtail", 0.02),
    "grid 12 x 12 revolute 0.02": lambda: patterns.grid(12, 12, "revolute", 0.02),
    "grid 16 x 16 arrow 0.01": lambda: patterns.grid(16, 16, "arrow", 0.01),
    "grid 20 x 20 dovetail 0.02": lambda: patterns.grid(20, 20, "dovetail", 0.02),
    "grid 30 x 4 dovetail 0.01": lambda: patterns.grid(30, 4, "dovetail", 0.01),
    "grid 27 x 25 tee 0.01": lambda: patterns.grid(27, 25, "tee", 0.01),
    "jigsaw 20 x 15 0.01": lambda: patterns.jigsaw(20, 15, 0.01),
    "jointpanel_10x10.svg": lambda: _drawing("jointpanel_10x10.svg", 0.2, "p-0", "p-99"),
    "pyjigsaw_10x10.svg": lambda: _drawing("pyjigsaw_10x10.svg", 1.0, "p1", "p100"),
    "butterfly": lambda: wr.read(ROOT / "21_butterfly" / "butterfly.json"),
}


def ask(assembly: Assembly) -> dict:
    """Answer and work of one question."""
    for _ in range(2):
        began = time.process_time()
        answer = wr.flex(assembly)
        spent = time.process_time() - began
    return {
        "parts": len(assembly.parts), "value": answer.objective, "verdict": answer.verdict, "path": answer.path,
        "rounds": answer.rounds, "iterations": answer.iterations, "seconds": round(spent, 3),
    }  # fmt: skip


def main() -> None:
    """Print one line an assembly."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="parts of names; by default all")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--against", type=Path)
    asked = parser.parse_args()
    before = json.loads(asked.against.read_text()) if asked.against else {}
    print("| assembly | parts | moves mm | before | lost | iterations | before | seconds | before | verdict | path |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- | --- |")
    found, lost = {}, 0
    for name, make in CASES.items():
        if asked.names and not any(part in name for part in asked.names):
            continue
        now = found[name] = ask(make())
        old = before.get(name)
        loss = 0.0 if old is None else 1 - now["value"] / old["value"]
        lost += loss > LOSS
        shown = (
            ("-", "-", "-", "-")
            if old is None
            else (f"{old['value']:.6f}", f"{loss:.1e}", old["iterations"], old["seconds"])
        )
        print(
            f"| {name} | {now['parts']} | {now['value']:.6f} | {shown[0]} | {shown[1]} | {now['iterations']} | {shown[2]} | "
            f"{now['seconds']} | {shown[3]} | {now['verdict']} | {now['path']} |",
            flush=True,
        )
        if asked.keep:
            asked.keep.write_text(json.dumps(found, indent=1) + "\n")
    if lost:
        raise SystemExit(f"{lost} lost more than {LOSS:g}")


if __name__ == "__main__":
    main()
