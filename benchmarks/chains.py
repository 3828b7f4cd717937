"""Chains against their true optimum: `python -m benchmarks.chains [--joints tee,swallowtail]`.

The true optimum comes from tests/oracle/chain_values.json, an exact dynamic programme over the turns of the links.
Every chain is asked twice: with its blocks as in the oracle, and from an assembly file where the whole lies turned by
37 degrees and 2,500 mm away, every outline is stored in a turned frame of its own and the gap is given in the file.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from tests.oracle.blocks import JOINTS, outline
from tests.oracle.chain import BLOCKS, GAPS, stored

import wiggleroom as wr

ANGLE, AWAY = np.radians(37.0), np.array([2500.0, 0.0])


def turn(angle: float) -> np.ndarray:
    """Rotation matrix."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def chain(joint: str, gap: float, n: int, *, moved: bool) -> str:
    """Assembly file of n blocks, the first fixed, the last pulled sideways."""
    ring, parts = outline(joint), []
    whole, away = (ANGLE, AWAY) if moved else (0.0, np.zeros(2))
    for k in range(n):
        own = 0.3 + 1.1 * k if moved else 0.0  # the outline lies in its frame turned by this
        place = turn(whole) @ (k, 0.0) + away
        at = [*place.tolist(), float(np.degrees(whole - own))]
        corners = (ring @ turn(own).T).tolist()
        parts.append({"name": f"b{k + 1}", "outline": corners, "at": at, "fixed": k == 0})
    pull = {"part": f"b{n}", "direction": (turn(whole) @ (0.0, 1.0)).tolist()}
    return json.dumps({"format": "wiggleroom/1", "gap": gap, "parts": parts, "pull": [pull]})


def ask(text: str) -> wr.Answer:
    """Answer for the text of an assembly file, read from a file."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "chain.json"
        file.write_text(text)
        return wr.flex(wr.read(file))


def main() -> None:
    """Print one line a chain."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--joints", default=",".join(JOINTS), help=f"of {', '.join(JOINTS)}")
    joints = parser.parse_args().joints.split(",")
    table = Table("joint", "gap", "blocks", "true optimum", "found / true - 1", "turned / found - 1", "verdict", "path")
    for joint in joints:
        for gap in GAPS:
            for n in BLOCKS:
                true, _ = stored(joint, gap, n)
                answer, other = (ask(chain(joint, gap, n, moved=m)) for m in (False, True))
                if answer.objective is None or other.objective is None:
                    raise RuntimeError(f"{joint} {gap} {n}: {answer.verdict}, turned: {other.verdict}")
                short, apart = answer.objective / true - 1, other.objective / answer.objective - 1
                same = answer.verdict is other.verdict and answer.path == other.path
                words = (str(answer.verdict), answer.path) if same else ("differ", "differ")
                table.add_row(joint, f"{gap}", f"{n}", f"{true:.6f}", f"{short:.1e}", f"{apart:.1e}", *words)
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
