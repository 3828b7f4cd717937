"""The same question has the same answer on a machine that is a hundred times faster or slower, unless a time is asked for."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent

ASKED = """
import sys, time
pace = float(sys.argv[1])
for name in ("perf_counter", "monotonic", "process_time", "time"):
    real = getattr(time, name)
    setattr(time, name, lambda real=real, begin=real(): begin + pace * (real() - begin))
import wiggleroom as wr
from wiggleroom.bound.displacement_bound import furthest
from wiggleroom.bound.dual_bound import with_bound_by_work

def told(found):
    names = "verdict", "certainty", "at_most", "objective", "escapes", "whole", "states", "questions"
    return [(n, len(v) if n == "escapes" else str(v)) for n in names if (v := getattr(found, n, None)) is not None]

grid = wr.patterns.grid(3, 3, joint="tee", gap=0.02)
tees = wr.patterns.chain(4, joint="tee", gap=0.02)
"""
PLACES = {
    "check": """
print(told(wr.check(grid)))
print(told(wr.check(wr.patterns.jigsaw(2, 2, gap=0.5, pitch=40))))
""",
    "displacement bound whose work ends": """
print(furthest(grid, 20.0), furthest(grid, 200.0))
""",
    "proof": """
answer = wr.flex(grid)
for work in (40.0, 400.0, 1200.0):
    done = wr.prove(answer, 1e-3, work=work)
    print(told(done), done.bound.why)
""",
    "bound by work": """
answer = wr.flex(grid, search=0)
print([told(with_bound_by_work(answer, work)) for work in (10.0, 100.0, 20_000.0)])
""",
    "bound in space": """
from tests.test_spatial_bound import dovetail
print(told(wr.flex(dovetail(2, 1.0), wr.Pull("hook", (0.0, 1.0, 0.0)))))
""",
}


QUICK = "displacement bound whose work ends", "bound in space"


@pytest.mark.parametrize("place", [p if p in QUICK else pytest.param(p, marks=pytest.mark.slow) for p in PLACES])
def test_answers_do_not_depend_on_the_clock(place):
    def answered(pace):
        ran = subprocess.run(
            [sys.executable, "-c", ASKED + PLACES[place], str(pace)],
            capture_output=True,
            text=True,
            check=False,
            cwd=ROOT,
        )
        assert not ran.returncode, ran.stderr
        return ran.stdout

    slow = answered(100.0)  # seconds pass a hundred times as fast: a slow machine
    assert slow == answered(0.01)
    assert slow.strip()
