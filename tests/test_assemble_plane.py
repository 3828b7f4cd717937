"""Puzzles put together in the plane, judged by where their pieces were before they were cut apart and shuffled."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray
from shapely import affinity

from wiggleroom.context import Context
from wiggleroom.errors import InputError, StoppedError
from wiggleroom.mating.cutting_sheet import CuttingSheet, Outlined
from wiggleroom.mating.planar_assembly import PlanarAssembly, assemble_plane
from wiggleroom.mating.planar_search import PlanarSearch, moved

Floats = NDArray[np.float64]


def zigzag(a: Floats, b: Floats, rng: np.random.Generator) -> shapely.LineString:
    """A cut from a to b with four random corners."""
    along = np.array([0, 0.2, 0.4, 0.6, 0.8, 1.0])
    away = np.concatenate([[0], rng.uniform(-0.15, 0.15, 4), [0]])
    normal = np.array([a[1] - b[1], b[0] - a[0]])
    return shapely.LineString(a + along[:, None] * (b - a) + away[:, None] * normal)


def puzzle(columns: int, rows: int, seed: int) -> list[shapely.Polygon]:
    """A board of 40 mm squares cut along random zigzags."""
    rng = np.random.default_rng(seed)
    lines = [shapely.box(0, 0, 40 * columns, 40 * rows).exterior]
    corner = lambda i, j: np.array([40.0 * i, 40.0 * j])  # noqa: E731
    lines += [zigzag(corner(i, j), corner(i, j + 1), rng) for i in range(1, columns) for j in range(rows)]
    lines += [zigzag(corner(i, j), corner(i + 1, j), rng) for i in range(columns) for j in range(1, rows)]
    return list(shapely.get_parts(shapely.polygonize([shapely.union_all(lines)])))


def shuffled(pieces: list[shapely.Polygon], seed: int) -> list[shapely.Polygon]:
    """Pieces turned by any angle, side by side; in the same order."""
    rng = np.random.default_rng(seed)
    made, x = [], 0.0
    for piece in pieces:
        turned = affinity.rotate(piece, rng.uniform(-180, 180))
        left, bottom, right, _ = turned.bounds
        made.append(affinity.translate(turned, x - left, -bottom))
        x += right - left + 5
    return made


def sheet_of(polygons: list[shapely.Polygon]) -> CuttingSheet:
    return CuttingSheet(tuple(Outlined(f"p{k}", polygon) for k, polygon in enumerate(polygons)), source="puzzle")


def placed(found: PlanarAssembly, polygons: list[shapely.Polygon]) -> dict[int, shapely.Polygon]:
    """The pieces as drawn, where the assembly has them."""
    return {
        row: moved(affinity.translate(polygons[row], *-found.centres[row]), pose)
        for body in found.bodies
        for row, pose in body.items()
    }


def error(got: dict[int, shapely.Polygon], truth: list[shapely.Polygon]) -> float:
    """Largest distance [mm] of a piece's centroid from where it was, after the best rigid motion of all."""
    a = np.array([complex(p.centroid.x, p.centroid.y) for p in got.values()])
    b = np.array([complex(truth[k].centroid.x, truth[k].centroid.y) for k in got])
    a, b = a - a.mean(), b - b.mean()
    spin = np.vdot(a, b)
    return float(abs(spin / abs(spin) * a - b).max())


@pytest.mark.parametrize(("clearance", "accuracy"), [(0.0, 1e-6), (0.2, 0.02), (-0.1, 0.02)])
def test_a_shuffled_puzzle_is_put_together_whatever_the_cut_took(clearance: float, accuracy: float) -> None:
    whole = puzzle(3, 3, seed=1)
    truth = [piece.buffer(-clearance / 2, join_style="mitre") for piece in whole]
    drawn = shuffled(truth, seed=2)
    found = assemble_plane(sheet_of(drawn))
    assert found.sure, found.doubts
    got = placed(found, drawn)
    assert len(got) == 9
    assert error(got, truth) < accuracy
    assert any("0.2 mm between" in note for note in found.notes) == (clearance == 0.2)
    outlines = [moved(found.outlines[k], pose) for body in found.bodies for k, pose in body.items()]
    overlap = sum(a.intersection(b).area for k, a in enumerate(outlines) for b in outlines[:k])
    assert overlap < 1e-6


def test_pieces_go_into_their_frame() -> None:
    whole = puzzle(3, 2, seed=5)
    board = shapely.union_all(whole)
    whole.append(board.buffer(15, join_style="mitre").difference(board))
    drawn = shuffled(whole, seed=3)
    found = assemble_plane(sheet_of(drawn))
    assert not found.unplaced
    assert len(found.bodies) == 1
    assert error(placed(found, drawn), whole) < 0.01


def test_two_pieces_that_can_change_places_are_not_sure() -> None:
    """The same tab twice: either piece fits either slot."""
    tab = shapely.Polygon([(0, 0), (30, 0), (30, 10), (18, 10), (20, 18), (10, 18), (12, 10), (0, 10)])
    other = tab.union(shapely.box(0, -15, 30, 0)).union(shapely.box(3, -25, 9, -14))
    base = shapely.box(-10, 10, 60, 40).difference(affinity.translate(tab, 0, 0))
    base = base.difference(affinity.translate(tab, 25, 0))
    found = assemble_plane(sheet_of(shuffled([base, tab, other], seed=1)))
    assert not found.unplaced
    assert found.doubts == ('"p1" fits in more than one way, and where p2 would fit as well',)


def test_a_stray_piece_is_left_out_and_said() -> None:
    pieces = [*puzzle(2, 2, seed=8), shapely.Point(0, 0).buffer(18)]
    found = assemble_plane(sheet_of(shuffled(pieces, seed=4)))
    assert found.unplaced == (4,)
    assert found.doubts == ("not placed: p4",)


def svg(polygons: list[shapely.Polygon]) -> str:
    """The sheet as a file of cutting lines."""
    _, _, wide, tall = shapely.total_bounds(polygons)
    paths = [
        "M" + "L".join(f"{x:.9f},{tall - y:.9f}" for x, y in shapely.get_coordinates(p.exterior).tolist()) + "Z"
        for p in polygons
    ]
    lines = "".join(f'<path id="p{k}" d="{d}" fill="none" stroke="red"/>' for k, d in enumerate(paths))
    return f'<svg xmlns="http://www.w3.org/2000/svg" width="{wide}mm" height="{tall}mm" viewBox="0 0 {wide} {tall}">{lines}</svg>'


def test_the_command_writes_an_assembly_that_can_be_asked(command: Callable[..., int], tmp_path: Path) -> None:
    drawing, out, said, picture = (tmp_path / name for name in ("sheet.svg", "out.json", "said.json", "out.svg"))
    drawing.write_text(svg(shuffled(puzzle(2, 2, seed=3), seed=6)))
    assert command("assemble", drawing, "-o", out, "--json", said, "--picture", picture) == 0
    record = json.loads(said.read_text())
    assert record["certainty"] == "sure"
    assert record["placed"] == record["panels"] == 4
    assert {len(joint["panels"]) for joint in record["joints"]} == {2}
    assert ">J1<" in picture.read_text()
    assert command("flex", out, "--gap", "0.2", "--fix", "p0", "--pull", "p3:+x") == 0


def test_what_is_about_space_needs_a_thickness(
    command: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drawing = tmp_path / "sheet.svg"
    drawing.write_text(svg(puzzle(2, 1, seed=3)))
    assert command("assemble", drawing, "--thickness", "lid:2.8", "-o", tmp_path / "out.json") == 2
    assert "give it, such as --thickness 3" in capsys.readouterr().err


def test_the_matching_of_outlines_stops_when_asked():
    class Asked:
        """Set once it was asked five times."""

        times = 0

        def is_set(self) -> bool:
            self.times += 1
            return self.times > 5

    asked = Asked()
    with pytest.raises(StoppedError):
        PlanarSearch(puzzle(3, 2, 1), Context(stop=asked))
    assert asked.times == 6


@pytest.mark.parametrize("count", [0, 1])
def test_a_sheet_of_one_part_is_refused(count: int) -> None:
    with pytest.raises(InputError, match=r"puzzle: has (no parts|only one part); at least two are needed"):
        assemble_plane(sheet_of([shapely.box(0, 0, 40, 30)][:count]))


@pytest.mark.parametrize(
    "other", [shapely.Point(90, 0).buffer(20), shapely.box(60, 0, 60.3, 0.3), shapely.Point(10, 0).buffer(20)]
)
def test_parts_that_fit_nowhere_are_not_placed(other: shapely.Polygon) -> None:
    assert assemble_plane(sheet_of([shapely.Point(0, 0).buffer(20), other])).unplaced == (0, 1)
