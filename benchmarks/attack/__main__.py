"""Random assemblies of many families, asked and judged: `python -m benchmarks.attack COUNT FIRST [--out DIR]`.

Assembly number k is of family k modulo their count. `flex` and `check` are asked about it, and their ends, paths, verdicts and values are
judged by polygons of shapely and by a short search of its own, see oracle.py and search.py, which import nothing of the package. Asked
again with the same DIR it goes on where it was stopped. What is wrong is written there: the assembly, what is wrong with the answer,
and the better path where there is one (the number of waypoints, then one a line: dx dy turn of all parts [mm, mm, rad]).
With `--space` it is about assemblies in space: families_solid.py draws them, judge_solids.py has them judged by the library python-fcl,
which also looks for ways out of what `check` says is interlocked, see search_solids.py. What is wrong is written as an assembly
file with its meshes.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks.attack.campaign import run, table
from benchmarks.attack.judge import PROGRAMS, severe


def main() -> int:
    """Run a campaign, print the table; 1 where something is wrong that must not be."""
    asked = argparse.ArgumentParser(prog="python -m benchmarks.attack", description=__doc__.splitlines()[0])
    asked.add_argument("count", type=int, help="so many assemblies")
    asked.add_argument("first", type=int, help="number of the first")
    asked.add_argument("--out", type=Path, default=Path("attack"), help="folder for the log and what is found")
    asked.add_argument(
        "--programs", type=int, default=PROGRAMS, help="linear programs of the search for better motions"
    )
    other = asked.add_mutually_exclusive_group()
    other.add_argument(
        "--studies", action="store_true", help="ask sweep, gap, sample, rank and tighten, see studies.py"
    )
    other.add_argument("--space", action="store_true", help="ask about parts in space, see families_solid.py")
    said = asked.parse_args()
    questions = "studies" if said.studies else "space" if said.space else "plane"
    findings = run(said.count, said.first, said.out, said.programs, questions)
    print(table(findings))
    wrong = [f for f in findings if severe(f)]
    for finding in wrong:
        print(f"{finding.family}_{finding.number}: {'; '.join(finding.wrong)}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
