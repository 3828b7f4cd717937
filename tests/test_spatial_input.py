"""Files of format wiggleroom/2: what is read from them, and one plain line for everything that is wrong."""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

import wiggleroom as wr
from wiggleroom.drawing.model import Pull
from wiggleroom.spatial.solids.solid_boolean import centroid_of
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial, read_spatial_assembly
from wiggleroom.spatial.solids.spatial_file import read_spatial
from wiggleroom.spatial.spatial_flex import flex_spatial

BOX = {"name": "a", "boxes": [[0, 0, 0, 4, 2, 2]]}
SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4]]


def text(*parts: dict, **more: object) -> str:
    return json.dumps({"format": "wiggleroom/2", "parts": list(parts), **more})


BAD = {
    "no parts": (text(), "has no parts"),
    "other format": (text(BOX).replace("wiggleroom/2", "wiggleroom/3"), 'format is "wiggleroom/3"'),
    "unit": (text(BOX, unit="feet"), 'unit is "feet"'),
    "gap": (text(BOX, gap=-1), "gap is -1"),
    "gap of no joint": (text(BOX, gaps=[{"parts": ["a"], "gap": 1}]), "must be a list of 2, not of 1"),
    "angle too large": (text(BOX | {"rotate": [0, 1e300, 0]}), 'part "a": rotate must be three angles in degrees'),
    "no material": (text({"name": "a"}), 'must have one of "outline", "mesh" or "boxes"'),
    "two materials": (text(BOX | {"mesh": "a.stl"}), 'has "mesh" and "boxes"'),
    "unknown field": (text(BOX | {"colour": "red"}), 'field "colour" is not known'),
    "twice": (text(BOX, BOX), "name is used 2 times"),
    "empty name": (text(BOX | {"name": " "}), "name must be printable"),
    "no thickness": (text({"name": "a", "outline": SQUARE}), '"thickness" is missing'),
    "thin": (text({"name": "a", "outline": SQUARE, "thickness": 0}), "thickness is 0"),
    "thickness of boxes": (text(BOX | {"thickness": 3}), 'go with "outline" only'),
    "two corners": (text({"name": "a", "outline": SQUARE[:2], "thickness": 1}), "needs at least 3 corners"),
    "flat hole": (
        text({"name": "a", "outline": SQUARE, "holes": [[[1, 1], [2, 2], [3, 3]]], "thickness": 1}),
        "hole 1 needs",
    ),
    "no boxes": (text({"name": "a", "boxes": []}), '"boxes" is empty'),
    "flat box": (text({"name": "a", "boxes": [[0, 0, 0, 1, 0, 1]]}), "boxes[0] must be x, y, z of the lower"),
    "far": (text(BOX | {"at": [1e12, 0, 0]}), "beyond 1e+09 mm"),
    "lock": (text(BOX | {"lock": ["w"]}), 'lock names "w"'),
    "density": (text(BOX | {"density": 0}), "density is 0"),
    "glue": (text(BOX, glue=[["a", "b"]]), 'there is no part "b"'),
    "ignore": (text(BOX, ignore=[["a", "a"]]), "must name two different parts"),
    "pull fixed": (
        text(BOX | {"fixed": True}, pull=[{"part": "a", "direction": [0, 0, 1]}]),
        "is fixed and cannot be pulled",
    ),
    "pull of what is glued to a fixed part": (
        text(
            BOX | {"fixed": True}, BOX | {"name": "b"}, glue=[["a", "b"]], pull=[{"part": "b", "direction": [0, 0, 1]}]
        ),
        'it is glued to "a", which is fixed',
    ),
    "gap of a joint twice": (
        text(BOX, BOX | {"name": "b"}, gaps=[{"parts": ["a", "b"], "gap": 0.1}, {"parts": ["b", "a"], "gap": 0.2}]),
        "parts a and b are given 2 times",
    ),
    "an outline that crosses itself in a joint with a gap of its own": (
        text(
            BOX,
            {"name": "b", "outline": [[0, 0], [4, 4], [4, 0], [0, 6]], "thickness": 3},
            gaps=[{"parts": ["a", "b"], "gap": 0.1}],
        ),
        'part "b" crosses itself at (2.4, 2.4)',
    ),
    "a hole outside in a joint with a gap of its own": (
        text(
            BOX,
            {"name": "b", "outline": SQUARE, "holes": [[[90, 0], [91, 0], [91, 1]]], "thickness": 3},
            gaps=[{"parts": ["a", "b"], "gap": 0.1}],
        ),
        'part "b" has a hole outside its outline',
    ),
    "gap far too large": (text(BOX, gap=1e300), "gap is 1e+300; it must be within 1e+09 mm"),
    "thickness in words": (text({"name": "a", "outline": SQUARE, "thickness": "3 mm"}), "must be a number, not text"),
    "not a number": (text(BOX | {"rotate": [float("nan"), 0, 0]}), "is not JSON (invalid character)"),
    "glue of one part": (text(BOX, glue=[["a"]]), "must name at least two different parts"),
    "pull nothing": (text(BOX, pull=[{"part": "a"}]), 'must have either "direction" or "turn"'),
    "pull zero": (text(BOX, pull=[{"part": "a", "direction": [0, 0, 0]}]), "the direction is zero"),
    "turn at a point": (
        text(BOX, pull=[{"part": "a", "turn": [0, 0, 1], "point": [0, 0, 0]}]),
        '"point" goes with "direction"',
    ),
    "mesh of a text": (text({"name": "a", "mesh": "a.stl"}), "this assembly is no file itself"),
    "not JSON": ('{"format": "wiggleroom/2",', "is not JSON"),
}


@pytest.mark.parametrize(("given", "said"), BAD.values(), ids=BAD)
def test_bad_input_gives_one_line(given: str, said: str) -> None:
    with pytest.raises(wr.InputError) as raised:
        assemble_spatial(read_spatial(given))
    assert len(raised.value.findings) == 1
    assert said in raised.value.findings[0]
    assert "\n" not in raised.value.findings[0]


def write(folder: Path, *parts: dict, **more: object) -> Path:
    file = folder / "a.json"
    file.write_text(text(*parts, **more))
    return file


TETRAHEDRON = (
    '<?xml version="1.0"?><model unit="%s" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>'
    '<object id="1" type="model" name="tet"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>'
    '<vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="%d" v3="1"/>'
    '<triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="2" v2="0" v3="3"/></triangles></mesh>'
    '</object></resources><build><item objectid="%d"/></build></model>'
)

FILES = {
    "missing": ("no.stl", "there is no such file"),
    "outside": ("../a.stl", "must lie in the folder"),
    "absolute": ("/etc/passwd", "must lie in the folder"),
    "folder": ("sub", "no mesh format"),
    "empty": ("empty.stl", "is empty"),
    "rubbish": ("rubbish.stl", "has no faces"),
    "no archive": ("no.3mf", "is not a 3MF archive"),
    "bomb": ("bomb.3mf", "unpacks to"),
    "open": ("open.stl", "is not closed"),
    "a corner that is not there": ("corner.3mf", "has faces with corners that are not there, of 4"),
    "a body that is not there": ("build.3mf", 'places none of its bodies, "tet"'),
    "unit nobody knows": ("parsec.3mf", 'its unit is "parsec"; it must be one of micron'),
    "cut short": ("short.stl", "closed mesh is needed"),
    "numbers that are none": ("nan.obj", "has coordinates that are no numbers"),
    "two bodies": ("two.glb", "has 2 bodies"),
    "no body": ("two.glb#c", 'there is no body "c"'),
}


@pytest.fixture(scope="module")
def bad_meshes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with all those files."""
    folder = tmp_path_factory.mktemp("meshes")
    (folder / "sub").mkdir()
    (folder / "empty.stl").write_bytes(b"")
    (folder / "rubbish.stl").write_bytes(b"solid what\nfacet nonsense\n")
    (folder / "no.3mf").write_bytes(b"PK nothing")
    with zipfile.ZipFile(folder / "bomb.3mf", "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("3D/3dmodel.model", b"\0" * 410_000_000)
    for name, unit, corner, built in (("corner", "inch", 20, 1), ("build", "inch", 2, 7), ("parsec", "parsec", 2, 1)):
        with zipfile.ZipFile(folder / f"{name}.3mf", "w") as archive:
            archive.writestr("3D/3dmodel.model", TETRAHEDRON % (unit, corner, built))
    (folder / "nan.obj").write_text("v nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    cube = trimesh.creation.box((1, 2, 3))
    (folder / "short.stl").write_bytes(cube.export(file_type="stl")[:-30])
    trimesh.Trimesh(cube.vertices, cube.faces[:6], process=False).export(folder / "open.stl")
    scene = trimesh.Scene({"a": cube, "b": trimesh.creation.box((1, 1, 1))})
    scene.export(folder / "two.glb")
    return folder


@pytest.mark.parametrize(("mesh", "said"), FILES.values(), ids=FILES)
def test_bad_mesh_files_give_one_line(
    bad_meshes: Path, mesh: str, said: str, capfd: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(wr.InputError) as raised:
        read_spatial(write(bad_meshes, {"name": "a", "mesh": mesh}))
    assert len(raised.value.findings) == 1
    assert said in raised.value.findings[0]
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("length", [1e-320, 1e300])
def test_a_direction_may_have_any_length(length: float) -> None:
    given = text(BOX | {"fixed": True}, BOX | {"name": "b", "boxes": [[0, 0, 3, 4, 2, 4], [-1, -1, -2, 5, 3, -1]]})
    answer = flex_spatial(assemble_spatial(read_spatial(given)), Pull("b", (0.0, 0.0, length)))
    assert answer.objective == pytest.approx(1.0, abs=1e-6)


def test_sheets_are_read_by_the_name_of_the_part(tmp_path: Path) -> None:
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="80mm" height="60mm" viewBox="0 0 80 60">'
    sheet = head + '<rect id="lid" width="80" height="30"/></svg>'
    (tmp_path / "sheet.svg").write_text(sheet)
    read = read_spatial_assembly(write(tmp_path, {"name": "lid", "outline": "sheet.svg#lid", "thickness": 3}))
    assert read.solids[0].volume == pytest.approx(80 * 30 * 3)
    assert np.allclose(read.solids[0].centroid, [40, 45, 1.5])  # y points up from the bottom of the sheet
    with pytest.raises(wr.InputError, match='has no part "box"; its parts are "lid"'):
        read_spatial(write(tmp_path, {"name": "lid", "outline": "sheet.svg#box", "thickness": 3}))


def test_boxes_that_share_no_face_are_one_part_and_that_is_said() -> None:
    corner = {"name": "a", "boxes": [[0, 0, 0, 1, 1, 1], [1, 1, 0, 2, 2, 1]]}
    joined = {"name": "b", "boxes": [[0, 0, 5, 1, 1, 6], [0.5, 0.5, 5.5, 2, 2, 6.5]]}
    assert read_spatial(text(corner, joined)).notes == (
        'part "a": boxes make 2 pieces that share no face; they move as one',
    )


def test_units_of_files_and_formats(tmp_path: Path) -> None:
    cube = trimesh.creation.box((2, 2, 2))
    cube.export(tmp_path / "a.stl")
    cube.export(tmp_path / "a.glb")
    parts = [{"name": k, "mesh": f"a.{k}", "at": [10 * i, 0, 0]} for i, k in enumerate(("stl", "glb"))]
    read = read_spatial_assembly(write(tmp_path, *parts, {"name": "b", "boxes": [[0, 0, 5, 1, 1, 6]]}, unit="cm"))
    assert [m.volume for m in read.solids] == pytest.approx([20.0**3, 2000.0**3, 10.0**3])
    assert read.parts[1].at[0] == 100


def test_the_gap_moves_every_face_of_the_union_inward() -> None:
    bar = {"name": "bar", "boxes": [[0, 0, 0, 60, 20, 20], [20, 20, 0, 40, 40, 20]]}
    made = assemble_spatial(read_spatial(text(bar, gap=0.4))).solids[0]
    assert centroid_of(made.surface)[0] == pytest.approx(59.6 * 19.6 * 19.6 + 19.6 * 20 * 19.6)
    assert made.volume == pytest.approx(60 * 20 * 20 + 20 * 20 * 20)
    plate = {"name": "p", "outline": SQUARE, "holes": [[[1, 1], [3, 1], [3, 3], [1, 3]]], "thickness": 3}
    made = assemble_spatial(read_spatial(text(plate, gap=0.2))).solids[0]
    assert centroid_of(made.surface)[0] == pytest.approx((3.8**2 - 2.2**2) * 2.8)
    with pytest.raises(wr.InputError, match="thickness 3 is used up by gap 3"):
        assemble_spatial(read_spatial(text(plate, gap=3)))
    with pytest.raises(wr.InputError, match=r"vanishes|falls"):
        assemble_spatial(read_spatial(text({"name": "p", "boxes": [[0, 0, 0, 1, 1, 1]]}, gap=2)))


def test_the_same_part_as_a_mesh_gives_the_same_answer(tmp_path: Path) -> None:
    hole = [[-5.2, -5.2], [5.2, -5.2], [5.2, 5.2], [-5.2, 5.2]]
    outer = [[-20, -20], [20, -20], [20, 20], [-20, 20]]
    plate = {"name": "plate", "outline": outer, "holes": [hole], "thickness": 12, "at": [0, 0, -6], "fixed": True}
    peg = {"name": "peg", "boxes": [[-5, -5, -20, 5, 5, 20]], "lock": ["z"]}
    exact = assemble_spatial(read_spatial(text(plate, peg)))
    goal = Pull("peg", (1, 0.2, 0), (0, 0, 20))
    truth = flex_spatial(exact, goal).objective
    surface = exact.solids[0].surface
    for ending in ("stl", "ply", "obj", "3mf"):
        trimesh.Trimesh(surface.vertices, surface.faces, process=False).export(tmp_path / f"plate.{ending}")
        as_mesh = {"name": "plate", "mesh": f"plate.{ending}", "at": [0, 0, -6], "fixed": True}
        answer = flex_spatial(read_spatial_assembly(write(tmp_path, as_mesh, peg)), goal)
        assert answer.objective == pytest.approx(truth, abs=1e-5)
        assert answer.path == "checked"
    inward = read_spatial_assembly(write(tmp_path, as_mesh, peg, gap=0.1))
    again = assemble_spatial(read_spatial(text(plate, peg, gap=0.1)))
    assert flex_spatial(inward, goal).objective == pytest.approx(flex_spatial(again, goal).objective, abs=1e-5)


def test_draw_and_parts_take_assemblies_in_space(tmp_path, command_output):
    source = "examples/48_dovetail_box/box.json"
    code, out, _ = command_output("parts", source, "--json", "-")
    assert code == 0
    listed = json.loads(out)
    assert listed["dimension"] == 3
    left = next(p for p in listed["parts"] if p["name"] == "left")
    drawn = next(p for p in json.loads(Path(source).read_text())["parts"] if p["name"] == "left")
    ((x0, y0, z0, x1, y1, z1),) = drawn["boxes"]
    assert left["fixed"]
    assert left["size"] == [x1 - x0, y1 - y0, z1 - z0]  # as drawn: the gap is not taken off
    assert command_output("draw", source, tmp_path / "drawn.svg")[0] == 0
    drawn = (tmp_path / "drawn.svg").read_text()
    assert all(f">{p['name']}<" in drawn for p in listed["parts"])


@pytest.mark.parametrize("kind", ["bytes", "text", "counted"])
@pytest.mark.parametrize("ending", [".stl", ".obj", ".ply", ".glb", ".3mf"])
def test_random_bytes_are_no_mesh(tmp_path: Path, ending: str, kind: str) -> None:
    for seed in range(2):
        rng = np.random.default_rng(seed)
        data = {
            "bytes": rng.bytes(3000),
            "text": b"solid x\nfacet normal 0 0 1\nouter loop\nvertex " + rng.bytes(300),
            "counted": rng.bytes(80) + (9).to_bytes(4, "little") + rng.bytes(450),
        }[kind]
        (tmp_path / f"a{ending}").write_bytes(data)
        with pytest.raises(wr.InputError) as refused:
            read_spatial(write(tmp_path, {"name": "a", "mesh": f"a{ending}"}))
        assert str(refused.value).isprintable()  # one plain line
        assert f"a{ending}: " in str(refused.value)


@pytest.mark.parametrize("link", ["../x.bin", "x.bin", "/etc/hostname"])
def test_a_glb_file_takes_nothing_from_other_files(tmp_path: Path, link: str) -> None:
    folder = tmp_path / "folder"
    (folder / "sub").mkdir(parents=True)
    glb = trimesh.creation.box((2, 2, 2)).export(file_type="glb")
    length = int.from_bytes(glb[12:16], "little")
    tree, buffer = json.loads(glb[20 : 20 + length]), glb[28 + length :]
    for place in (tmp_path, folder, folder / "sub"):
        (place / "x.bin").write_bytes(buffer)
    tree["buffers"][0]["uri"] = link
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    head = b"glTF" + (2).to_bytes(4, "little") + (20 + len(text)).to_bytes(4, "little")
    (folder / "a.glb").write_bytes(head + len(text).to_bytes(4, "little") + b"JSON" + text)
    with pytest.raises(wr.InputError, match="from another file; save it as one file"):
        read_spatial(write(folder, {"name": "a", "mesh": "a.glb"}))


def test_an_assembly_is_made_again_from_its_drawing_or_from_what_was_made() -> None:
    cube = {"name": "a", "boxes": [[0, 0, 0, 10, 10, 10]]}
    assembly = assemble_spatial(read_spatial(text(cube, gap=0.4)))
    assert wr.assemble(assembly.drawing, gap=1.0, fix=["a"]).size == pytest.approx(9.0)
    again = wr.assemble(assembly.as_cut(), gap=1.0)
    assert again.size == pytest.approx(9.6 - 1.0)
    assert again.dimension == again.drawing.dimension == assembly.as_cut().dimension == 3
    with pytest.raises(wr.InputError, match="assemble: offset: for drawings only"):
        wr.assemble(assembly.drawing, offset={"a": 0.1})


def test_parts_of_the_plane_and_of_space_are_not_mixed() -> None:
    drawn = read_spatial(text({"name": "a", "boxes": [[0, 0, 0, 10, 10, 10]]}))
    flat = wr.Part("b", (wr.Region(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])),))
    with pytest.raises(wr.InputError, match='part "b" is in the plane'):
        wr.assemble(wr.Drawing((*drawn.parts, flat)))


def test_names_in_space_are_checked_as_those_of_drawings_are() -> None:
    drawn = read_spatial(text({"name": "box", "boxes": [[0, 0, 0, 10, 10, 10]]}))
    with pytest.raises(wr.InputError) as refused:
        wr.assemble(replace(drawn, glue=(("box", "bax"),), ignore=(("box", "box2"),)))
    assert [line.split(": ", 1)[1] for line in refused.value.findings] == [
        'glue: there is no part "bax": did you mean "box"?',
        'ignore: there is no part "box2": did you mean "box"?',
    ]
