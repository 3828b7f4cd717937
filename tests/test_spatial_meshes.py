"""Meshes as parts: what they enclose is the part, small faults are mended and said, the rest is refused."""

from __future__ import annotations

import json
import time
from pathlib import Path

import manifold3d
import numpy as np
import pytest
import trimesh
from benchmarks.attack.families_solid import draw_solids
from scipy.spatial.transform import Rotation

import wiggleroom as wr
from tests.test_spatial_input import write
from wiggleroom.drawing.model import Pull
from wiggleroom.spatial.solids.convex import convex_piece
from wiggleroom.spatial.solids.convex_hulls import hull_surface
from wiggleroom.spatial.solids.made_solids import made_solid
from wiggleroom.spatial.solids.mesh_pieces import in_pieces
from wiggleroom.spatial.solids.solid_boolean import centroid_of, solid_of, surface_of, union_of, volume_of
from wiggleroom.spatial.solids.spatial_assembly import read_spatial_assembly
from wiggleroom.spatial.solids.spatial_file import read_spatial
from wiggleroom.spatial.spatial_flex import flex_spatial


def test_small_faults_of_meshes_are_mended_and_said(tmp_path: Path) -> None:
    cube = trimesh.creation.box((2, 2, 2))
    cube.invert()
    cube.export(tmp_path / "a.stl")
    drawing = read_spatial(write(tmp_path, {"name": "a", "mesh": "a.stl"}))
    assert any("outward now" in note for note in drawing.notes)
    assert made_solid(drawing.parts[0], 0.0)[0].volume == pytest.approx(8)


@pytest.mark.parametrize(
    ("shift", "volume", "said"),
    [
        ((2, 2, 2), 120, "2 closed surfaces overlap or touch"),
        ((4, 0, 0), 128, "2 closed surfaces overlap or touch"),
        ((0, 0, 20), 128, "2 pieces that share no face"),
        ((4, 4, 0), 128, "2 pieces that share no face"),
    ],
    ids=["overlap", "share a face", "apart", "share an edge"],
)
def test_closed_surfaces_of_one_mesh_are_one_part_as_boxes_are(tmp_path: Path, shift, volume: float, said: str) -> None:
    cubes = [trimesh.creation.box((4, 4, 4)), trimesh.creation.box((4, 4, 4)).apply_translation(shift)]
    trimesh.util.concatenate(cubes).export(tmp_path / "two.stl")
    boxes = [[-2, -2, -2, 2, 2, 2], [*(np.array(shift) - 2).tolist(), *(np.array(shift) + 2).tolist()]]
    drawing = read_spatial(write(tmp_path, {"name": "a", "mesh": "two.stl"}, {"name": "b", "boxes": boxes}))
    assert any(said in note for note in drawing.notes)
    mesh, same = (made_solid(p, 0.2)[0] for p in drawing.parts)
    assert mesh is not None
    assert same is not None
    assert abs(mesh.volume - volume) < 1e-9
    assert np.allclose(mesh.centroid, same.centroid, atol=1e-9)
    assert abs(centroid_of(mesh.surface)[0] - centroid_of(same.surface)[0]) < 1e-9


def _obj(*bodies: tuple[str, float], faces: str = "") -> str:
    """Cubes of 2 in an OBJ file, each with lines before it and the x of its middle; a line before the last six of their faces."""
    lines: list[str] = []
    for number, (head, x) in enumerate(bodies):
        cube = trimesh.creation.box((2, 2, 2)).apply_translation((x, 0, 0))
        sides = ["f {} {} {}".format(*(face + 1 + 8 * number)) for face in cube.faces]
        lines += [head, *("v {} {} {}".format(*v) for v in cube.vertices), *sides[:6], faces, *sides[6:]]
    return "\n".join(lines)


def test_bodies_of_an_obj_file_are_its_objects(tmp_path: Path) -> None:
    (tmp_path / "two.obj").write_text(_obj(("o one", 0), ("o two", 9)))
    with pytest.raises(wr.InputError, match="has 2 bodies; name one as"):
        read_spatial(write(tmp_path, {"name": "a", "mesh": "two.obj"}))
    for body, x in (("one", 0), ("two", 9)):
        drawing = read_spatial(write(tmp_path, {"name": "a", "mesh": f"two.obj#{body}"}))
        made = made_solid(drawing.parts[0], 0.0)[0]
        assert made.volume == pytest.approx(8)
        assert made.centroid == pytest.approx((x, 0, 0), abs=1e-9)


def test_disjoint_bodies_of_a_mesh_are_parts_by_number(tmp_path: Path) -> None:
    """The largest first, then by place; a body in the hollow of another is one of its own."""
    shells = [trimesh.creation.box((4, 4, 4)), trimesh.creation.box((3, 3, 3)), trimesh.creation.box((1, 1, 1))]
    shells[1].invert()
    others = [trimesh.creation.box((2, 2, 2)).apply_translation(at) for at in ((20, 0, 0), (9, 0, 0), (9, 0, -5))]
    trimesh.util.concatenate([others[0], *shells, *others[1:]]).export(tmp_path / "a.stl")
    expected = [(64 - 27, (0, 0, 0)), (8, (9, 0, -5)), (8, (9, 0, 0)), (8, (20, 0, 0)), (1, (0, 0, 0))]
    parts = [{"name": f"p{k}", "mesh": f"a.stl#{k + 1}"} for k in range(5)]
    drawing = read_spatial(write(tmp_path, *parts))
    assert drawing.notes == ()
    for part, (volume, middle) in zip(drawing.parts, expected, strict=True):
        made = made_solid(part, 0.0)[0]
        assert made.volume == pytest.approx(volume)
        assert made.centroid == pytest.approx(middle, abs=1e-6)
    for wrong in ("a.stl#6", "a.stl#0", "a.stl#one"):
        with pytest.raises(wr.InputError, match="there is no body"):
            read_spatial(write(tmp_path, {"name": "a", "mesh": wrong}))
    whole = read_spatial(write(tmp_path, {"name": "a", "mesh": "a.stl"}))
    assert any('name one as "a.stl#1"' in note for note in whole.notes)


def test_named_bodies_of_several_solids_are_parts_by_name_and_number(tmp_path: Path) -> None:
    lines = _obj(("o one", 0), ("", 5), ("o two", 9)).splitlines()
    (tmp_path / "a.obj").write_text("\n".join(line for line in lines if line))
    parts = [{"name": n, "mesh": f"a.obj#{n}"} for n in ("one#1", "one#2", "two")]
    drawing = read_spatial(write(tmp_path, *parts))
    middles = [made_solid(part, 0.0)[0].centroid[0] for part in drawing.parts]
    assert middles == pytest.approx([0, 5, 9], abs=1e-9)


@pytest.mark.parametrize("closed", [True, False])
def test_groups_of_an_obj_file_are_its_bodies_where_they_are_closed(tmp_path: Path, closed: bool) -> None:
    bodies = _obj(("g one", 0), ("g two", 9)) if closed else _obj(("g one", 0), ("g two", 9), faces="g rest")
    (tmp_path / "a.obj").write_text(bodies)
    named = read_spatial(write(tmp_path, {"name": "a", "mesh": "a.obj#two" if closed else "a.obj#2"}))
    assert made_solid(named.parts[0], 0.0)[0].centroid == pytest.approx((9, 0, 0), abs=1e-9)


def test_bodies_of_a_mesh_file_are_listed_without_cutting_it(tmp_path: Path, monkeypatch, command_output) -> None:
    from wiggleroom.spatial.solids import mesh_pieces

    def never(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr(mesh_pieces, "convex_pieces", never)
    torus = trimesh.creation.torus(10, 3, major_sections=60, minor_sections=30)
    trimesh.util.concatenate([trimesh.creation.box((2, 3, 4)), torus]).export(tmp_path / "a.stl")
    code, out, _ = command_output("parts", tmp_path / "a.stl", "--json", "-", "--unit", "cm")
    assert code == 0
    listed = json.loads(out)["parts"]
    assert [p["name"] for p in listed] == ["a.stl#1", "a.stl#2"]
    assert [p["volume"] for p in listed] == pytest.approx([1000 * torus.volume, 24_000], rel=1e-5)
    assert listed[1]["size"] == pytest.approx([20, 30, 40])
    assert {p["pieces"] for p in listed} == {None}


@pytest.mark.parametrize(
    ("size", "unit", "asked"), [(20, "mm", False), (0.02, "mm", True), (0.02, "m", False), (9000, "mm", True)]
)
def test_units_are_asked_about_where_a_mesh_is_tiny_or_huge(
    tmp_path: Path, size: float, unit: str, asked: bool
) -> None:
    trimesh.creation.box((size, size, size)).export(tmp_path / "a.stl")
    trimesh.creation.box((size / 50, size / 50, size / 50)).export(tmp_path / "b.stl")
    parts = [{"name": n, "mesh": f"{n}.stl"} for n in "ab"]
    notes = read_spatial(write(tmp_path, *parts, unit=unit)).notes
    assert len(notes) == asked
    assert all("a.stl: is" in note and "says no unit" in note for note in notes)


def test_walls_thinner_than_the_gap_are_named(tmp_path: Path) -> None:
    """A cup of walls 2 thick, one of them 0.3."""
    cup = trimesh.boolean.difference(
        [
            trimesh.creation.box(bounds=[(0, 0, 0), (20, 20, 20)]),
            trimesh.creation.box(bounds=[(0.3, 2, 2), (18, 18, 30)]),
        ],
        engine="manifold",
    )
    cup.export(tmp_path / "a.stl")
    file = write(tmp_path, {"name": "a", "mesh": "a.stl"})
    with pytest.raises(wr.InputError, match=r"is thinner than the gap behind the face at \(0(\.3)?, ") as raised:
        read_spatial_assembly(file, gap=0.4)
    assert len(raised.value.findings) == 1
    assert read_spatial_assembly(file, gap=0.2).solids[0].pieces


def test_a_mesh_that_crosses_itself_is_what_it_encloses(tmp_path: Path) -> None:
    """One shell: a bar bent round so that its end goes through its beginning."""
    import shapely

    from wiggleroom.spatial.solids.mesh_file import MeshFiles

    ring = np.array([(0, 0), (10, 0), (10, 10), (2, 10), (2, -5), (4, -5), (4, 8), (8, 8), (8, 2), (0, 2)], dtype=float)
    flat = [(0, 8, 9), (0, 1, 8), (1, 2, 7), (1, 7, 8), (2, 3, 7), (3, 6, 7), (3, 4, 6), (4, 5, 6)]
    corners = np.vstack([np.column_stack([ring, np.full(10, z)]) for z in (0.0, 3.0)])
    low = [f[::-1] for f in flat]
    high = [tuple(i + 10 for i in f) for f in flat]
    walls = [w for k in range(10) for w in ((k, (k + 1) % 10, (k + 1) % 10 + 10), (k, (k + 1) % 10 + 10, k + 10))]
    trimesh.Trimesh(corners, [*low, *high, *walls], process=False).export(tmp_path / "a.stl")
    surface, notes = MeshFiles(1.0).read(tmp_path / "a.stl")
    assert [note for note in notes if "crosses itself at" in note]
    truth = shapely.union_all([shapely.Polygon(ring[list(f)]) for f in flat]).area * 3
    assert centroid_of(surface)[0] == pytest.approx(truth, rel=1e-9)


def _with(faces: np.ndarray, *corners: tuple[float, float, float]) -> trimesh.Trimesh:
    """A cube of 4 with further faces and corners, as they are."""
    cube = trimesh.creation.box((4, 4, 4))
    return trimesh.Trimesh(np.vstack([cube.vertices, *corners]), np.vstack([cube.faces, faces]), process=False)


_CUBE = trimesh.creation.box((4, 4, 4)).faces


@pytest.mark.parametrize(
    ("mesh", "said"),
    [
        (_with(np.array([[0, 1, 8], [1, 0, 8]]), (6.0, 0.0, 0.0)), "2 faces lie on each other and enclose nothing"),
        (
            _with(np.array([[8, 9, 10], [8, 10, 9]]), (9.0, 9.0, 9.0), (10.0, 9.0, 9.0), (9.0, 10.0, 9.0)),
            "2 faces lie on each other and enclose nothing",
        ),
        (_with(_CUBE[:3]), "3 faces were there twice"),
        (_with(_CUBE[:, ::-1]), "12 faces were there twice"),
    ],
    ids=["fin", "loose fin", "three twice", "all both ways"],
)
def test_faces_on_each_other_are_one_face_or_none(tmp_path: Path, mesh: trimesh.Trimesh, said: str) -> None:
    mesh.export(tmp_path / "a.ply")
    drawing = read_spatial(write(tmp_path, {"name": "a", "mesh": "a.ply"}))
    assert len(drawing.notes) == 1
    assert said in drawing.notes[0]
    assert made_solid(drawing.parts[0], 0.0)[0].volume == pytest.approx(64)


def _shells(*shells: tuple[float, float, bool]) -> trimesh.Trimesh:
    """Cubes by their side, the x of their middle, and whether they look inward."""
    cubes = [trimesh.creation.box((side, side, side)).apply_translation((x, 0, 0)) for side, x, _ in shells]
    for cube, (_, _, inward) in zip(cubes, shells, strict=True):
        if inward:
            cube.invert()
    return trimesh.util.concatenate(cubes)


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (_shells((4, 0, False), (2, 0, True), (2, 2, False)), 64 - 8 + 4),
        (_shells((6, 0, False), (4, 0, True), (2, 1.5, False)), 216 - 64 + 8 - 2),
        (_shells((6, 0, False), (4, 0, True), (2, 1, False)), 216 - 64 + 8),
        (_shells((6, 0, False), (4, 1, True)), 216 - 64),
    ],
    ids=["a body in the wall", "an island in the wall", "an island at the wall", "a hollow that opens"],
)
def test_bodies_that_meet_a_hollow_are_one_with_it(tmp_path: Path, mesh: trimesh.Trimesh, volume: float) -> None:
    mesh.export(tmp_path / "a.ply")
    drawing = read_spatial(write(tmp_path, {"name": "a", "mesh": "a.ply"}))
    assert any("overlap or touch; the part is their union" in note for note in drawing.notes)
    assert made_solid(drawing.parts[0], 0.0)[0].volume == pytest.approx(volume)


@pytest.mark.parametrize(
    "mesh",
    [
        _shells((4, 0, False), (2, 2, True)),
        _shells((4, 0, False), (2, 9, True)),
        _shells((9, 0, False), (4, 1, True), (4, -1, True)),
        _shells((9, 0, False), (4, 0, True), (2, 0, True)),
    ],
    ids=["crosses the skin", "lies outside", "crosses another", "lies in another"],
)
def test_a_surface_that_looks_inward_is_round_a_hollow_or_refused(tmp_path: Path, mesh: trimesh.Trimesh) -> None:
    mesh.export(tmp_path / "a.ply")
    with pytest.raises(wr.InputError, match="a surface that looks inward is not round a hollow"):
        read_spatial(write(tmp_path, {"name": "a", "mesh": "a.ply"}))


@pytest.mark.parametrize(("island", "pieces"), [(1, 2), (2, 3)])
def test_islands_in_hollows_of_a_mesh_are_told(tmp_path: Path, island: int, pieces: int) -> None:
    """A hollow cube, with a hollow cube in its hollow, with a cube in the hollow of that."""
    sides = [10, 8, 6, 4, 2][: 2 * island + 1 if island == 2 else 2 + island]
    shells = [trimesh.creation.box((side, side, side)) for side in sides]
    for hollow in shells[1::2]:
        hollow.invert()
    trimesh.util.concatenate(shells).export(tmp_path / "a.ply")
    drawing = read_spatial(write(tmp_path, {"name": "a", "mesh": "a.ply"}))
    told = [note for note in drawing.notes if "share no face" in note]
    assert len(told) == (pieces > 1)
    assert all(f"has {pieces} pieces" in note for note in told)


@pytest.mark.parametrize("gap", [0.0, 0.2])
def test_a_part_shut_up_in_a_mesh_stops_at_its_walls(tmp_path: Path, gap: float) -> None:
    hollow = [trimesh.creation.box((6, 6, 6)), trimesh.creation.box((6, 6, 6)).apply_translation((9, 0, 0))]
    block = trimesh.boolean.difference([trimesh.creation.box((30, 10, 10)), *hollow], engine="manifold")
    block.export(tmp_path / "block.stl")
    drawn = write(
        tmp_path, {"name": "s", "mesh": "block.stl", "fixed": True}, {"name": "b", "boxes": [[-2, -2, -2, 2, 2, 2]]}
    )
    assembly = read_spatial_assembly(drawn, gap=gap)
    assert abs(flex_spatial(assembly, Pull("b", (1, 0, 0))).objective - 1 - gap) < 1e-6


def test_a_mesh_whose_faces_cannot_meet_again_is_covered_and_that_is_said(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=1).difference(trimesh.creation.box((3, 0.5, 0.5)))
    ball.export(tmp_path / "a.stl")
    file = write(tmp_path, {"name": "a", "mesh": "a.stl"}, gap=0.05)
    covered = read_spatial_assembly(file)
    assert 0 < covered.overshoot <= 0.05 / 8
    assert sum("is covered by" in note for note in covered.drawing.notes) == 1
    assert read_spatial_assembly(file, gap=0.0).overshoot == 0


@pytest.mark.parametrize(("joint", "turned"), [("finger", False), ("swallowtail", True)])
def test_a_mesh_of_a_plate_is_made_as_the_plate_is(joint: str, turned: bool) -> None:
    import shapely
    import trimesh

    from wiggleroom.drawing.model import Part, Plate, Region, Surface

    ring = wr.patterns.chain(3, joint=joint, gap=0.04).drawing.parts[1].regions[0].outer
    mesh = trimesh.creation.extrude_polygon(shapely.Polygon(ring), 0.5, engine="manifold")
    R = Rotation.from_euler("xyz", [20, 50, 70], degrees=True).as_matrix() if turned else np.eye(3)
    surface = Surface(np.array(mesh.vertices) @ R.T, np.array(mesh.faces, dtype=np.int64))
    plate, wrong = made_solid(Part("a", solid=Plate((Region(ring),), 0.5)), 0.04)
    solid, also_wrong = made_solid(Part("a", solid=surface), 0.04)
    assert (wrong, also_wrong) == ([], [])
    assert plate is not None
    assert solid is not None
    volume = solid_of(plate.surface).volume()
    assert solid_of(solid.surface).volume() == pytest.approx(volume, rel=1e-9)
    together = union_of([solid_of(hull_surface(piece.corners)) for piece in in_pieces(solid, float).pieces])
    assert together.volume() == pytest.approx(volume, rel=1e-9)


@pytest.mark.parametrize(("what", "gap", "truth"), [("peg", 0.1, 0.3), ("slots", 0.1, 1.1)])
def test_parts_that_were_turned_before_an_stl_file_rounded_them(
    tmp_path: Path, what: str, gap: float, truth: float
) -> None:
    from shapely import box
    from trimesh.creation import extrude_polygon

    def slab(shape, low: float, high: float):
        return extrude_polygon(shape, high - low, engine="manifold").apply_translation((0, 0, low))

    if what == "peg":
        plate = slab(box(-20, -20, 20, 20) - box(-5.2, -5.2, 5.2, 5.2), -6, 6)
        peg, direction = slab(box(-5, -5, 5, 5), -20, 20), (1, 0, 0)
    else:
        holes = box(-12, -2, -6, 2) | box(6, -2, 12, 2)
        direction = (0, 0, -1)
        bridge = [slab(box(-20, -2, 20, 2), 9, 11), *(slab(box(x, -2, x + 4, 2), 0, 11) for x in (-20, 16))]
        plate = trimesh.boolean.union([slab(box(-20, -20, 20, 20) - holes, 0, 3), *bridge], engine="manifold")
        tabs = [slab(box(x, -1.8, x + 5.4, 1.8), -1, 5) for x in (-11.7, 6.3)]
        peg = trimesh.boolean.union([*tabs, slab(box(-14, -1.8, 14, 1.8), 4, 8)], engine="manifold")
    R = Rotation.random(random_state=2)
    at = np.random.default_rng(2).uniform(-30, 30, 3)
    for name, mesh in (("plate", plate), ("peg", peg)):
        mesh.vertices = R.apply(mesh.vertices) + at
        mesh.export(tmp_path / f"{name}.stl")
    parts = [
        {"name": "plate", "mesh": "plate.stl", "fixed": True},
        {"name": "peg", "mesh": "peg.stl", "lock": ["rx", "ry", "rz"]},
    ]
    pull = [{"part": "peg", "direction": R.apply(direction).tolist()}]
    (tmp_path / "a.json").write_text(
        json.dumps({"format": "wiggleroom/2", "unit": "mm", "gap": gap, "parts": parts, "pull": pull})
    )
    assert wr.flex(wr.read(tmp_path / "a.json")).objective == pytest.approx(truth, abs=1e-5)


def test_what_a_file_has_not_rounded_stays_as_it_is() -> None:
    from wiggleroom.drawing.model import Surface
    from wiggleroom.spatial.solids.rounded_corners import with_flat_faces

    ball = trimesh.creation.icosphere(subdivisions=3, radius=10)
    dented = trimesh.creation.box((10, 10, 10)).subdivide()
    corner = np.flatnonzero((dented.vertices == [0, 0, 5]).all(axis=1))
    for mesh, out in ((ball, 0.0), (dented, 1e-4)):
        mesh.vertices[corner] += [0, 0, out]
        drawn = Surface(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64))
        kept, moved = with_flat_faces(drawn, 1e-6)
        assert moved < 1e-10
        assert np.abs(kept.vertices - mesh.vertices).max() < 1e-10


def _cover_without_floor(diagonal: bool) -> trimesh.Trimesh:
    """A box of 20 round a hollow of 16 by 16 by 18 whose floor has no thickness, as one surface."""
    o, i = [(0, 0), (20, 0), (20, 20), (0, 20)], [(2, 2), (18, 2), (18, 18), (2, 18)]
    corners = [(*p, 0) for p in o] + [(*p, 20) for p in o] + [(*p, 0) for p in i] + [(*p, 18) for p in i]
    faces = [(4, 5, 6), (4, 6, 7), (12, 14, 13), (12, 15, 14)]  # above: of the box, of the hollow
    faces += [(8, 9, 10), (8, 10, 11)]  # the floor from within
    faces += [(8, 11, 9), (11, 10, 9)] if diagonal else [(8, 10, 9), (8, 11, 10)]  # and from below
    for k in range(4):
        m = (k + 1) % 4
        faces += [(k, m, 4 + m), (k, 4 + m, 4 + k)]  # walls of the box
        faces += [(8 + m, 8 + k, 12 + m), (12 + m, 8 + k, 12 + k)]  # of the hollow
        faces += [(m, k, 8 + k), (m, 8 + k, 8 + m)]  # the rim below
    return trimesh.Trimesh(corners, faces, process=False)


@pytest.mark.parametrize(("diagonal", "turn"), [(True, 0.3), (False, 0.0)])
def test_a_floor_without_thickness_is_refused_or_left_out_with_a_note(
    tmp_path: Path, diagonal: bool, turn: float
) -> None:
    mesh = _cover_without_floor(diagonal)
    assert mesh.volume == pytest.approx(20**3 - 16 * 16 * 18)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(turn, (1, 2, 3))).export(tmp_path / "a.stl")
    try:
        drawing = read_spatial(write(tmp_path, {"name": "a", "mesh": "a.stl"}))
    except wr.InputError:
        return  # cannot be told what is solid
    assert any("enclose nothing" in note or "without thickness" in note for note in drawing.notes)
    assert made_solid(drawing.parts[0], 0.0)[0].volume == pytest.approx(20**3 - 16 * 16 * 18, rel=1e-5)


@pytest.mark.parametrize(
    ("boxes", "volume", "said"),
    [
        ([((0, 0, 0), (6, 6, 6), 1), ((0, 1, 1), (4, 5, 5), -1)], 216 - 64, "walls without thickness are left out"),
        ([((0, 0, 0), (6, 6, 6), 1), ((1, 1, 1), (3, 5, 5), -1), ((3, 1, 1), (5, 5, 5), -1)], 216 - 64, "left out"),
        ([((0, 0, 0), (2, 2, 2), 1), ((2, 0.5, 0.5), (4, 1.5, 1.5), 1)], 10, "their union"),
        ([((0, 0, 0), (6, 6, 6), 1), ((2, 2, 2), (4, 4, 4), 1)], 216, "their union"),
        ([((0, 0, 0), (2, 2, 2), 1), ((2, 2, 0), (4, 4, 2), 1)], 16, "share no face"),
        ([((0, 0, 0), (6, 6, 6), 1), ((1, 1, 1), (3, 3, 5), -1), ((3, 3, 1), (5, 5, 5), -1)], 216 - 32, ""),
    ],
    ids=["floor", "wall between hollows", "on a face", "nested", "at an edge", "hollows at an edge"],
)
def test_what_shells_enclose_together_is_the_part(tmp_path: Path, boxes: list, volume: float, said: str) -> None:
    shells = []
    for low, high, looks in boxes:
        shells.append(trimesh.creation.box(bounds=[low, high]))
        if looks < 0:
            shells[-1].invert()
    trimesh.util.concatenate(shells).export(tmp_path / "a.stl")
    drawing = read_spatial(write(tmp_path, {"name": "a", "mesh": "a.stl"}))
    assert said in " ".join(drawing.notes)
    made = made_solid(drawing.parts[0], 0.0)[0]
    assert made.volume == pytest.approx(volume)
    together = union_of([solid_of(hull_surface(piece.corners)) for piece in in_pieces(made, float).pieces])
    assert together.volume() == pytest.approx(volume)


def test_round_meshes_of_many_faces_are_made_soon() -> None:
    ball = trimesh.creation.icosphere(subdivisions=5)
    began = time.process_time()
    piece = convex_piece(ball.vertices)
    assert time.process_time() - began < 20  # each axis against each other took minutes
    assert len(piece.corners) == len(ball.vertices)
    opposite = {tuple(sorted((tuple(n), tuple(-n)))) for n in ball.face_normals.round(6) + 0.0}
    assert len(piece.normals) == len(opposite)


def test_cutting_a_mesh_into_pieces_ends_with_the_time(tmp_path: Path, command_output) -> None:
    torus = trimesh.creation.torus(10, 3, major_sections=32, minor_sections=24)
    torus.export(tmp_path / "a.stl")
    file = write(
        tmp_path, {"name": "a", "mesh": "a.stl", "fixed": True}, {"name": "b", "boxes": [[20, 0, 0, 21, 1, 1]]}
    )
    code, _, err = command_output("check", file, "--time", 0.02)
    assert code in (2, 3)
    assert "stopped after 0.02 s" in " ".join(err)


@pytest.mark.parametrize("depth", [1.0, -1.0])
def test_a_slit_without_thickness_is_left_out_and_a_wall_is_refused(tmp_path: Path, depth: float) -> None:
    """A box of 4 by 4 by 2 with a pocket of no width in its lid, or with one that is turned out: a wall on it."""
    corners = [(x, y, z) for z in (0, 2) for x, y in ((0, 0), (4, 0), (4, 4), (0, 4))]
    corners += [(2, 1, 2), (2, 3, 2), (2, 3, 2 - depth), (2, 1, 2 - depth)]
    faces = [(0, 2, 1), (0, 3, 2)]
    for k in range(4):
        m = (k + 1) % 4
        faces += [(k, m, 4 + m), (k, 4 + m, 4 + k)]
    faces += [(4, 5, 8), (5, 6, 9), (5, 9, 8), (6, 7, 9), (7, 4, 8), (7, 8, 9)]
    faces += [(8, 9, 10), (8, 10, 11), (9, 8, 11), (9, 11, 10)]  # two sides with other diagonals
    trimesh.Trimesh(corners, faces, process=False).export(tmp_path / "a.stl")
    file = write(tmp_path, {"name": "a", "mesh": "a.stl"})
    if depth < 0:
        with pytest.raises(wr.InputError, match="walls without thickness"):
            read_spatial(file)
        return
    drawing = read_spatial(file)
    assert any("slits without thickness" in note for note in drawing.notes)
    assert made_solid(drawing.parts[0], 0.0)[0].volume == pytest.approx(32, rel=1e-5)


def test_a_slit_that_shares_faces_with_the_outside_is_left_out(tmp_path: Path) -> None:
    """Leaves of hinges whose arms meet their knuckles in a slit: one triangle of the mesh is half slit, half outside."""
    _, made = draw_solids(2950024)
    drawing = read_spatial(made.write(tmp_path))
    for part in drawing.parts[:2]:
        drawn = trimesh.load(tmp_path / f"{part.name}.stl")
        assert made_solid(part, 0.0)[0].volume == pytest.approx(drawn.volume, rel=1e-6)


def test_a_mesh_that_crosses_itself_by_a_sliver_is_as_drawn(tmp_path: Path) -> None:
    """A cut whose two walls go through each other at its ground, by 0.0003 mm in 20."""
    from wiggleroom.spatial.solids.mesh_file import MeshFiles

    across = manifold3d.CrossSection([[(-0.5, 11), (-0.0003, 2), (0.0003, 2), (0.5, 11)]])
    cut = manifold3d.Manifold.extrude(across, 30).translate((0, 0, -15))
    surface = surface_of(manifold3d.Manifold.cube((20, 20, 20), True) - cut)
    ground = np.abs(surface.vertices[:, 0]) < 1e-3
    assert ground.sum() == 4
    surface.vertices[ground, 0] *= -1
    trimesh.Trimesh(surface.vertices, surface.faces, process=False).export(tmp_path / "a.ply")
    read, notes = MeshFiles(1.0).read(tmp_path / "a.ply")
    assert any("crosses itself at" in note and "the part is as drawn" in note for note in notes), notes
    assert volume_of(read) == pytest.approx(volume_of(surface), rel=1e-6)


def test_an_object_of_two_colours_is_one_body(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text("mtllib none.mtl\n" + _obj(("o x\nusemtl red", 0), faces="usemtl blue"))
    drawing = read_spatial(write(tmp_path, {"name": "a", "mesh": "a.obj"}))
    assert made_solid(drawing.parts[0], 0.0)[0].volume == pytest.approx(8)


@pytest.mark.parametrize("turned", range(2))
def test_a_turned_leaf_keeps_its_volume(turned: int) -> None:
    """Facets of a knuckle beside an arm have corners in line: the library may flip edges between two facets."""
    from shapely import Polygon, box
    from trimesh.creation import extrude_polygon

    from wiggleroom.drawing.model import Surface
    from wiggleroom.spatial.solids.solid_boolean import solid_of

    angle = 2 * np.pi * (np.arange(6) + 0.5) / 6
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    whole, arm = Polygon(5 * ring), box(0, -1.5, 20, 1.5)
    knuckle = (whole - Polygon(2.5 * ring)).union(arm - whole)
    slabs = [(knuckle, 0.0, 7.0), (knuckle, 14.2, 21.2), (box(6, -1.5, 20, 1.5), 0.0, 21.2)]
    meshes = [
        extrude_polygon(shape, high - low, engine="manifold").apply_translation((0, 0, low))
        for shape, low, high in slabs
    ]
    leaf = trimesh.boolean.union(meshes, engine="manifold")
    R = Rotation.random(random_state=turned).as_matrix()
    surface = Surface(np.array(leaf.vertices) @ R.T, np.array(leaf.faces, dtype=np.int64))
    assert solid_of(surface).volume() == pytest.approx(knuckle.area * 14 + 14 * 3 * 7.2, rel=1e-6)
