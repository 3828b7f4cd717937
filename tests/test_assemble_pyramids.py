"""Boxes whose walls lean: put together where they were designed, judged by solids built from the file alone and by closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
from scipy.spatial.distance import pdist

from wiggleroom.mating.joint_angles import FingeredCorner, trihedral_angles

pytest.importorskip("manifold3d")

from benchmarks.sheet_drawings import Design
from benchmarks.sheet_judge import judge

from wiggleroom.mating.assembled_sheet import AssembledSheet, assemble_sheet
from wiggleroom.mating.cutting_sheet import read_sheet
from wiggleroom.mating.plates_writer import write_plates

Floats = np.ndarray
T, HIGH, ROWS = 3.0, 60.0, 9
TABS = ((-12.0, -6.0), (4.0, 10.0))


def turns(sides: int, lean: float) -> tuple[float, float]:
    """By how much plates turn from the floor to a wall and from wall to wall, from the normals [rad]."""
    b = np.radians(lean)
    return float(np.arccos(np.sin(b))), float(np.arccos(np.cos(b) ** 2 * np.cos(2 * np.pi / sides) + np.sin(b) ** 2))


def depths(turn: float) -> tuple[float, float]:
    """Of tips and of the plate's body from where the outer faces meet, within the plate [mm]: fingers end at the outer face.

    In a sharp joint they are as long as the plate is thick, and begin where the inner faces meet.
    """
    inner = T * np.tan(turn / 2)
    return (0.0, T * np.sin(turn)) if turn < np.pi / 2 else (inner - T, inner)


def regular(sides: int, apothem: float) -> Floats:
    around = 0.3 + (2 * np.arange(sides) - 1) * np.pi / sides
    return apothem / np.cos(np.pi / sides) * np.column_stack([np.cos(around), np.sin(around)])


def strip(corner: Floats, along: Floats, inward: Floats, ends: tuple[float, float], deep: tuple[float, float]):
    return shapely.Polygon(
        [corner + along * v + inward * w for v, w in zip(np.repeat(ends, 2), (*deep, *deep[::-1]), strict=True)]
    )


def polygon_plate(sides: int, apothem: float, turn: float) -> shapely.Polygon:
    """Floor or lid: the tabs of the walls cut out of its edges."""
    tip, body = depths(turn)
    plate = shapely.Polygon(regular(sides, apothem - tip))
    for around in 0.3 + 2 * np.arange(sides) * np.pi / sides:
        out, along = np.array([np.cos(around), np.sin(around)]), np.array([-np.sin(around), np.cos(around)])
        cuts = [strip(apothem * out, along, -out, tab, (-1.0, body)) for tab in TABS]
        plate = plate.difference(shapely.union_all(cuts))
    return plate


def pyramid(sides: int, apothem: float, lean: float, *, lid: bool = False) -> Design:
    """Truncated pyramid on a regular polygon, its outer faces where the apothem of the floor and the walls' height HIGH say.

    Parameters
    ----------
    apothem : float [mm]
        Of the floor's outer face.
    lean : float [degrees]
        Of the walls from upright, outward.
    """
    floor_turn, wall_turn = turns(sides, lean)
    wide = apothem + HIGH * np.sin(np.radians(lean))
    low, high = (r * np.tan(np.pi / sides) for r in (apothem, wide))
    tip, body = depths(floor_turn)
    lid_tip, lid_body = depths(np.pi - floor_turn) if lid else (0.0, 0.0)
    top, far = HIGH - lid_body, 500.0
    wall = shapely.Polygon([(-low, 0), (low, 0), (high, HIGH), (-high, HIGH)])
    wall = wall.intersection(shapely.box(-far, body, far, top))
    wall = wall.union(shapely.union_all([shapely.box(u, tip, v, body) for u, v in TABS]))
    wall = wall.union(shapely.union_all([shapely.box(u, top, v, HIGH - lid_tip) for u, v in TABS] if lid else []))
    tip, deep = depths(wall_turn)
    for side in (-1, 1):
        corner = np.array([side * low, 0.0])
        along = np.array([side * (high - low), HIGH]) / np.hypot(high - low, HIGH)
        inward = np.array([-side * along[1], side * along[0]])
        ends = np.linspace(body, top, ROWS + 1) / along[1]
        ends[0], ends[-1] = -far, far
        wall = wall.difference(strip(corner, along, inward, (-far, far), (-far, tip)))
        for i in range(side > 0, ROWS, 2):
            wall = wall.difference(strip(corner, along, inward, (ends[i], ends[i + 1]), (-far, deep)))
    panels = {"floor": polygon_plate(sides, apothem, floor_turn)} | {f"wall {k}": wall for k in range(sides)}
    joined = {frozenset({f"wall {k}", f"wall {(k + 1) % sides}"}) for k in range(sides)}
    if lid:
        panels["lid"] = polygon_plate(sides, wide, np.pi - floor_turn)
    joined |= {frozenset({f"wall {k}", flat}) for k in range(sides) for flat in ("floor", "lid")[: 1 + lid]}
    return Design("pyramid", T, panels, joined, (0.0, 0.0, 0.0))


def designed_centroids(design: Design, sides: int, apothem: float, lean: float) -> Floats:
    """Middles (n, 3) of all panels where they are meant to be [mm]."""
    b, at = np.radians(lean), np.array(design.panels["wall 0"].centroid.coords[0])
    out, up = np.array([np.cos(b), 0, -np.sin(b)]), np.array([np.sin(b), 0, np.cos(b)])
    middle = np.array([apothem, 0, 0]) + at[0] * np.array([0, 1, 0]) + at[1] * up - T / 2 * out
    around = 2 * np.pi * np.arange(sides) / sides
    c, s = np.cos(around), np.sin(around)
    walls = np.column_stack([c * middle[0] - s * middle[1], s * middle[0] + c * middle[1], np.full(sides, middle[2])])
    flat = [[*design.panels["floor"].centroid.coords[0], T / 2]]
    if "lid" in design.panels:
        flat.append([*design.panels["lid"].centroid.coords[0], HIGH * np.cos(b) - T / 2])
    return np.vstack([walls, flat])


def assembled(folder: Path, design: Design) -> AssembledSheet:
    (folder / "sheet.svg").write_text(design.svg(3))
    return assemble_sheet(read_sheet(folder / "sheet.svg"), T)


@pytest.mark.parametrize(
    ("sides", "apothem", "lean", "lid"),
    [
        (3, 45.0, 25.0, False),
        (4, 60.0, -15.0, True),
        (6, 45.0, 40.0, True),
    ],
)
def test_a_truncated_pyramid_comes_together_as_it_was_designed(
    tmp_path: Path, sides: int, apothem: float, lean: float, lid: bool
) -> None:
    design = pyramid(sides, apothem, lean, lid=lid)
    found = assembled(tmp_path, design)
    (tmp_path / "out.json").write_text(write_plates(found))
    judged = judge(tmp_path / "out.json")
    assert set(judged.names) == set(design.panels)
    assert judged.overlap < 1e-5
    assert {frozenset(found.plates[k].name.split()[0] for k in joint.panels) for joint in found.joints} == {
        frozenset(name.split()[0] for name in pair) for pair in design.joined
    }
    assert len(found.joints) == len(design.joined)
    (body,) = found.bodies
    asked = designed_centroids(design, sides, apothem, lean)
    assert np.abs(np.sort(pdist(body.moves)) - np.sort(pdist(asked))).max() < 0.5
    # Edges that are cut square press on each other where walls lean; where panels belong is sure all the same.
    assert all("press on each other" in doubt for doubt in found.doubts), found.doubts


@pytest.mark.slow
def test_a_pyramid_without_one_wall_is_not_sure(tmp_path: Path) -> None:
    design = pyramid(5, 45.0, 20.0)
    del design.panels["wall 3"]
    assert not assembled(tmp_path, design).sure


def test_corners_whose_fingers_are_made_for_other_angles_say_nothing() -> None:
    upright = FingeredCorner(90.0, (8, 1.0), (8, 0.8))
    assert not list(trihedral_angles([FingeredCorner(120.0, (8, 1.0), (8, 1.0)), upright]))
    upright = FingeredCorner(90.0, (8, 1.0), (8, 0.87))
    found = list(trihedral_angles([FingeredCorner(120.0, (8, 1.0), (8, 1.0)), upright]))
    assert np.abs(np.array(found) - 60.0).min() < 1e-9
