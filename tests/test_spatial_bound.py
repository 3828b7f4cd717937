"""Upper bounds in space, where all parts move in one plane: against closed forms, the plane, and cross-sections of other shapes."""

from __future__ import annotations

import json

import numpy as np
import pytest

import wiggleroom as wr
from tests.test_spatial import spatial
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.cli import main

CYCLE = {0: ["x", "ry", "rz"], 1: ["y", "rz", "rx"], 2: ["z", "rx", "ry"]}
"""Locks that leave the motions of the plane across an axis."""


def turned(points: list[list[float]], axis: int) -> list[list[float]]:
    """Boxes along other axes: z becomes the given one."""
    found = []
    for box in points:
        corners = np.roll(np.reshape(box, (2, 3)), axis - 2, axis=1)
        found.append(corners.ravel().tolist())
    return found


def dovetail(axis: int, high: float) -> Assembly:
    """A hook in a pocket; above a level the pocket is wider, so cross-sections differ."""
    pocket = [
        [-3, -3, 0, 3, 0, 1],
        [-3, 0, 0, -1, 3, 1],
        [1, 0, 0, 3, 3, 1],
        [-3, 3, 0, -0.4, 4, 1],
        [0.4, 3, 0, 3, 4, 1],
    ]
    wide = [[-3, -3, 1, 3, 0, 2], [-3, 0, 1, -2, 4, 2], [2, 0, 1, 3, 4, 2]]
    hook = [[-0.8, 0.2, 0, 0.8, 2.8, high], [-0.2, 2.8, 0, 0.2, 6, high]]
    return spatial(
        {"name": "pocket", "boxes": turned([*pocket, *wide], axis), "fixed": True},
        {"name": "hook", "boxes": turned(hook, axis), "lock": CYCLE[axis]},
    )


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("high", [1.0, 2.0])
def test_what_moves_in_a_plane_has_a_bound_near_the_motion(axis: int, high: float) -> None:
    assembly = dovetail(axis, high)
    along = np.roll([0.0, 1.0, 0.0], axis - 2)
    found = wr.flex(assembly, wr.Pull("hook", tuple(along)))
    assert found.objective == pytest.approx(
        0.2, abs=1e-6
    )  # the hook's shoulder meets the narrow mouth, at the lower level
    assert found.at_most is not None
    assert found.objective <= found.at_most < 0.2 * 1.2
    turn = wr.flex(assembly, wr.Turn("hook", tuple(np.roll([0.0, 0.0, -1.0], axis - 2))))
    assert turn.at_most is None or turn.objective <= turn.at_most


def test_a_film_in_a_cross_section_leaves_the_bound_as_it_is() -> None:
    """A film beside the pocket, of which the section keeps less than a billionth of its size."""
    with_film = dovetail(2, 2.0)
    film = [[-4, -3, 0, -4 + 8e-9, 5, 2]]
    pocket, hook = with_film.drawing.parts
    boxes = [box.ravel().tolist() for box in pocket.solid.boxes]
    again = spatial(
        {"name": "pocket", "boxes": [*boxes, *film], "fixed": True},
        {"name": "hook", "boxes": [box.ravel().tolist() for box in hook.solid.boxes], "lock": CYCLE[2]},
    )
    pull = wr.Pull("hook", (0.0, 1.0, 0.0))
    assert wr.flex(again, pull).at_most == pytest.approx(wr.flex(with_film, pull).at_most, rel=1e-6)


def test_a_weighted_pull_across_the_plane_counts_only_what_lies_in_it() -> None:
    found = wr.flex(dovetail(2, 1.0), wr.Pull("hook", (0.0, 0.6, 0.8), weight=5.0))
    assert found.objective == pytest.approx(5 * 0.6 * 0.2, abs=1e-5)
    assert found.at_most is not None
    assert found.objective <= found.at_most


@pytest.mark.parametrize("joint", ["swallowtail", "dovetail"])
def test_extruded_chains_are_proven_as_in_the_plane(joint: str) -> None:
    flat = wr.patterns.chain(3, joint=joint, gap=0.01)
    parts = [
        {"name": p.name, "outline": p.regions[0].outer.tolist(), "thickness": 0.4, "at": [*p.at[:2], 0], "fixed": p.fixed, "lock": CYCLE[2]}
        for p in flat.drawing.parts
    ]  # fmt: skip
    last = flat.drawing.parts[-1]
    found = wr.flex(spatial(*parts, gap=0.01), wr.Pull(last.name, (0, 1, 0), (*last.at[:2], 0.2)))
    truth = wr.flex(flat, wr.Pull(last.name, (0, 1)), search=0)
    assert found.verdict == "proven"
    assert found.objective == pytest.approx(truth.objective, rel=1e-6)
    assert truth.objective < found.at_most < 1.001 * truth.objective


def test_parts_that_move_in_space_have_no_bound_and_that_is_said(tmp_path, monkeypatch, capsys) -> None:
    peg = {"name": "peg", "boxes": [[0.1, 0.1, 0.1, 0.9, 0.9, 3]]}
    sides = [[-1, -1, 0, 0, 2, 2], [1, -1, 0, 2, 2, 2], [0, -1, 0, 1, 0, 2], [0, 1, 0, 1, 2, 2]]
    walls = {"name": "walls", "boxes": [[-1, -1, -1, 2, 2, 0], *sides], "fixed": True}
    found = wr.flex(spatial(peg, walls), wr.Pull("peg", (1, 0, 0)))
    assert found.at_most is None
    file = tmp_path / "peg.json"
    for lock, known in ((CYCLE[2], True), ([], False)):
        file.write_text(json.dumps({"format": "wiggleroom/2", "parts": [peg | {"lock": lock}, walls]}))
        monkeypatch.setattr("sys.argv", ["wiggleroom", "flex", str(file), "--pull", "peg:+x"])
        main()
        assert ("at most" in capsys.readouterr().out) == known
