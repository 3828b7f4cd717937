"""Round outlines drawn with corners hold no more than circles do."""

from __future__ import annotations

import json

import numpy as np
import pytest
from benchmarks.attack import drawing
from benchmarks.attack.oracle import Ground

import wiggleroom as wr


def off_centre(count: int, seed: int, folder) -> tuple[wr.Assembly, float, Ground]:
    """A disc in a round hole, pulled at a point beside its middle; what a circle reaches, less what the hole's corners may take."""
    rng = np.random.default_rng([seed, count])
    off, direction = rng.uniform(0.02, 0.6) * np.array(drawing.anywhere(rng)), np.array(drawing.anywhere(rng))
    gap = float(rng.uniform(0.02, 0.04))
    plate = drawing.cut(drawing.box(-2, -2, 2, 2), drawing.disc(1 + gap, count))
    parts = [drawing.part("plate", plate, fixed=True), drawing.part("disc", drawing.disc(1, count))]
    made = drawing.assembly(parts, [drawing.pull("disc", direction, off.tolist())])
    (folder / "made.json").write_text(json.dumps(made))
    reach = float(np.hypot(*off) - direction @ off + (1 + gap) * np.cos(np.pi / count) - 1)
    return wr.read(folder / "made.json"), reach, Ground(made)


@pytest.mark.parametrize(("count", "seed"), [(24, 1), (48, 2), (300, 3)])
def test_an_off_centre_pull_turns_a_disc_as_far_as_a_circle(count, seed, tmp_path):
    assembly, reach, ground = off_centre(count, seed, tmp_path)
    answer = wr.flex(assembly)
    assert answer.objective > 0.998 * reach
    assert answer.verdict == "proven" or count > 200  # such outlines are simplified
    assert answer.path == "checked"
    assert ground.overlap_on(answer.waypoints) is None


@pytest.mark.parametrize(("count", "seed"), [(700, 4), (1500, 5)])
def test_so_it_does_with_very_many_corners(count, seed, tmp_path):
    assembly, reach, ground = off_centre(count, seed, tmp_path)
    answer = wr.flex(assembly)
    assert answer.objective > 0.998 * reach
    assert answer.path == "checked"
    assert ground.overlap_on(answer.waypoints) is None
