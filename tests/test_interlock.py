"""Does it come apart: assemblies of known truth, paths audited by dense sampling, proofs against independent floods."""

from __future__ import annotations

import json
import threading
from pathlib import Path

import numpy as np
import pytest
import shapely

import wiggleroom as wr
from tests.flexing import displaced, part_at
from tests.oracle import collision
from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.assembly.build import assemble
from wiggleroom.context import UNLIMITED
from wiggleroom.disassembly.escape_effort import EscapeEffort
from wiggleroom.disassembly.interlock import interlock
from wiggleroom.drawing.model import Drawing
from wiggleroom.errors import FreeSpaceError
from wiggleroom.freespace.subdivision.passage import passage
from wiggleroom.report.results.separability import check_result, further, why

HERE = Path(__file__).parents[1] / "examples" / "17_does_it_come_apart"
TRUTH = json.loads((HERE / "truth.json").read_text())
WALL = shapely.box(0, 0, 100, 100)


def made(gap: float = 0.0, fixed: str = "wall", **shapes: shapely.Polygon) -> Assembly:
    parts = [part_at(n, s, (*s.centroid.coords[0], 0.0), n == fixed) for n, s in shapes.items()]
    return assemble(Drawing(tuple(parts), gap=gap))


def deepest(assembly: Assembly, found: wr.Interlock, between: int = 25) -> float:
    """Largest common area of two parts anywhere along all paths, parts that left before excepted, by dense sampling."""
    shapes = [shapely.union_all([shapely.Polygon(r.outer, r.holes) for r in p.regions]) for p in assembly.parts]
    names, gone, worst = assembly.names, set(), 0.0
    glued = [set(g) for g in assembly.drawing.glue]
    for escape in found.escapes:
        for one, other in zip(escape.path[:-1], escape.path[1:], strict=True):
            for t in np.linspace(0, 1, between):
                at = assembly.rest + one + t * (other - one)
                moved = [shapely.transform(s, lambda p, q=q: place(p, q)) for s, q in zip(shapes, at, strict=True)]
                for i, j in np.stack(shapely.STRtree(moved).query(moved)).T:
                    pair = {names[i], names[j]}
                    if i < j and not pair & gone and not any(pair <= g for g in glued):
                        worst = max(worst, shapely.intersection(moved[i], moved[j]).area)
        gone |= set(escape.parts)
    return worst


def away(assembly: Assembly, found: wr.Interlock) -> bool:
    """True where the parts of every escape end outside the hull of all that are left."""
    gone: set[str] = set()
    for escape in found.escapes:
        at = assembly.rest + escape.path[-1]
        points = {
            p.name: np.vstack([place(r.outer, q) for r in p.regions]) for p, q in zip(assembly.parts, at, strict=True)
        }
        gone |= set(escape.parts)
        left = shapely.MultiPoint(np.vstack([v for n, v in points.items() if n not in gone])).convex_hull
        them = shapely.MultiPoint(np.vstack([points[n] for n in escape.parts])).convex_hull
        if left.intersects(them):
            return False
    return True


@pytest.mark.parametrize("name", TRUTH)
def test_assemblies_of_known_truth(name):
    truth = TRUTH[name]
    assembly = wr.read(HERE / f"{truth['file']}.json", gap=truth.get("gap"))
    found = wr.check(assembly)
    assert found.verdict == truth["verdict"]
    assert found.certainty == truth["certainty"]
    assert [sorted(e.parts) for e in found.escapes] == truth["escapes"]
    assert list(found.spins) == truth["spins"]
    assert deepest(assembly, found) < 1e-9 * assembly.size**2
    assert away(assembly, found)


@pytest.mark.parametrize("name", ["rotation"])
def test_truth_does_not_hang_on_place_and_axes(name):
    drawing = wr.read(HERE / f"{name}.json").drawing
    assembly = assemble(displaced(drawing, 0.7, (300.0, -80.0)))
    found = wr.check(assembly)
    assert found.verdict == TRUTH[name]["verdict"]
    assert deepest(assembly, found) < 1e-9 * assembly.size**2


def corridor(*boxes: tuple[float, float, float, float]) -> shapely.Polygon:
    """The wall with channels cut into it."""
    return WALL.difference(shapely.union_all([shapely.box(*b) for b in boxes]))


@pytest.mark.parametrize(
    ("channels", "block", "verdict"),
    [
        ([(20, 20, 80, 40), (60, 20, 80, 110)], (20, 20, 40, 40), "comes apart"),  # right, then up
        ([(20, 20, 80, 50), (20, 50, 40, 110)], (60, 20, 80, 40), "comes apart"),  # back to the left, then up
        ([(10, 10, 80, 30), (60, 10, 80, 60), (10, 40, 80, 60), (10, 40, 30, 110)], (10, 10, 30, 30), "comes apart"),
        ([(20, 20, 80, 40), (60, 20, 80, 110)], (20, 20, 50, 40), "interlocked"),  # too long for the corner
    ],
    ids=["L", "back", "S", "too long"],
)
def test_paths_with_corners(channels, block, verdict):
    assembly = made(1.0, wall=corridor(*channels), block=shapely.box(*block))
    found = wr.check(assembly)
    assert found.verdict == verdict
    assert found.certainty == "proven"
    assert deepest(assembly, found) < 1e-9 * assembly.size**2


def test_a_gate_that_cannot_leave_is_moved_aside():
    wall = shapely.box(-60, 0, 100, 100).difference(
        shapely.union_all([shapely.box(20, 20, 60, 40), shapely.box(40, 20, 60, 110), shapely.box(-10, 50, 60, 65)])
    )
    assembly = made(1.0, wall=wall, block=shapely.box(20, 20, 40, 40), gate=shapely.box(10, 50, 60, 65))
    found = wr.check(assembly)
    assert found.escapes[0].parts == ("block",)
    assert found.escapes[0].path[:, 2].any(), "the gate has to move too"
    assert deepest(assembly, found) < 1e-9 * assembly.size**2


def test_nothing_fixed_the_largest_stands():
    assembly = made(
        0.4, "", small=shapely.box(20, 10, 30, 20), large=shapely.box(0, 0, 30, 30) - shapely.box(20, 10, 30, 20)
    )
    found = wr.check(assembly)
    assert [e.parts for e in found.escapes] == [("small",)]
    assert not found.escapes[0].path[:, 1].any()


@pytest.mark.slow
def test_a_jigsaw_of_twenty_is_proven_to_interlock_and_falls_apart_when_loose():
    file = HERE.parent / "drawings" / "pyjigsaw_4x5.svg"
    tight = wr.check(wr.read(file, gap=1.0))
    assert (tight.verdict, tight.certainty, len(tight.remains)) == ("interlocked", "proven", 20)
    loose = wr.read(file, gap=4.0)
    found = wr.check(loose)
    assert found.verdict == "comes apart"
    assert sum(len(e.parts) for e in found.escapes) == 19
    assert away(loose, found)


def test_interrupted_is_unknown():
    stop = threading.Event()
    stop.set()
    assert wr.check(wr.read(HERE / "simultaneous.json"), stop=stop).verdict == "unknown"


def test_what_cannot_be_asked():
    with pytest.raises(wr.InputError, match="only one part"):
        wr.check(made(fixed="", one=WALL))


def _flooded(a: shapely.Polygon, b: shapely.Polygon, step: float, turn: float, most: int = 400_000) -> bool:
    """True where a flood over a plain grid of motions, without any reasoning, leaves a window of 60 steps."""
    seen = {(0, 0, 0)}
    front = [(0, 0, 0)]
    while front and len(seen) < most:
        around = {
            (x + dx, y + dy, z + dz)
            for x, y, z in front
            for dx, dy, dz in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
        } - seen
        front = sorted(around)
        if not front:
            break
        hit = collision.overlaps(a, b, np.array(front) * (step, step, turn), np.zeros(2))
        front = [f for f, h in zip(front, hit, strict=True) if not h]
        seen |= around
        if any(max(abs(x), abs(y)) > 60 for x, y, _ in front):
            return True
    return False


@pytest.mark.parametrize(
    ("family", "gap"),
    [
        ("tee", 0.03),
        ("swallowtail", 0.03),
        ("swallowtail", 0.08),
        ("dovetail", 0.08),
        ("finger", 0.03),
        ("jigsaw", 0.08),
    ],
)
def test_a_pair_is_closed_where_a_plain_flood_stays_inside(family, gap):
    try:
        one, other = wr.patterns.chain(2, joint=family, gap=gap).parts
    except wr.InputError:
        pytest.skip("no such joint at this gap")
    a, b = (shapely.transform(shapely.Polygon(p.regions[0].outer), lambda c, p=p: place(c, p.at)) for p in (one, other))
    pivot = (1.0, 0.0)
    a, b = (shapely.transform(s, lambda c: c - pivot) for s in (a, b))
    found = passage(a, b, most=200_000)
    assert found.closed != (found.path is not None)
    if found.closed:  # a flood on a grid may miss a path, but must not find one that is not there
        assert not _flooded(a, b, gap / 4, gap / 2)
    else:
        assert not collision.overlaps(
            *(shapely.transform(s, lambda c: c - found.pivot) for s in (a, b)), found.path, np.zeros(2)
        ).any()


@pytest.mark.slow
def test_largest_gap_of_two_swallowtail_blocks():
    found = wr.largest_gap(wr.patterns.chain(2, joint="swallowtail", gap=0.02))
    assert 0.0600 <= found.holds < found.parts_at <= 0.0605
    assert found.parts_at - found.holds <= 1e-3 * found.parts_at
    assert (found.interlocked.verdict, found.apart.verdict) == ("interlocked", "comes apart")
    assert deepest(found.apart.assembly, found.apart) < 1e-9


def test_largest_gap_where_none_holds():
    found = wr.largest_gap(wr.patterns.chain(2, joint="finger", gap=0.02))
    assert found.holds is None
    assert found.apart.verdict == "comes apart"
    assert found.apart.at_most is None


def test_command_says_who_leaves_and_exits_with_one(command, tmp_path, capsys):
    out, film = tmp_path / "apart.json", tmp_path / "apart.film.svg"
    code = command("check", str(HERE / "sequential.json"), "--json", str(out), "--picture", str(film))
    page = capsys.readouterr().out
    assert code == 1
    assert "comes apart" in page
    assert page.index("latch") < page.index("drawer leaves")
    record = json.loads(out.read_text())
    assert (record["format"], record["verdict"], record["certainty"]) == ("wiggleroom.check/1", "comes apart", "proven")
    assert [e["parts"] for e in record["escapes"]] == [["latch"], ["drawer"]]
    first = record["escapes"][0]["path"]
    assert first[0] == {"latch": {"dx": 0.0, "dy": 0.0, "turn_deg": 0.0}}
    assert first[-1]["latch"]["dy"] > 50
    assert "<svg" in film.read_text()


def test_command_exits_with_zero_where_it_interlocks(command, capsys):
    assert command("check", str(HERE / "round_plug.json"), "--json", "-") == 0
    record = json.loads(capsys.readouterr().out)
    assert (record["verdict"], record["escapes"], record["spins"]) == ("interlocked", [], ["plug"])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--fix", "nobody"], "nobody"),
        (["--fix", "right,left"], "every part is fixed"),
        (["--picture", "apart.docx"], "must end in"),
    ],
)
def test_command_refuses_in_one_plain_line(command, capsys, words, said):
    assert command("check", str(HERE / "gap.json"), *words) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


# -- drawn tight ----------------------------------------------------------------------------------------------------


PEG = shapely.box(10, 10, 20, 20)
TRAY = shapely.box(0, 0, 30, 30) - PEG


@pytest.mark.parametrize(
    ("ground", "verdict", "certainty", "who"),
    [
        (TRAY, "interlocked", "proven", []),
        (TRAY - shapely.box(0, 20, 30, 30), "comes apart", "searched", [("peg",)]),
        (shapely.box(0, 0, 30, 10), "comes apart", "searched", [("peg",)]),
    ],
)
def test_parts_that_touch_at_rest(ground, verdict, certainty, who):
    found = wr.check(made(fixed="ground", ground=ground, peg=PEG))
    assert (found.verdict, found.certainty) == (verdict, certainty)
    assert [e.parts for e in found.escapes] == who


@pytest.mark.slow
@pytest.mark.parametrize(("gap", "verdict"), [(2.6201, "interlocked"), (2.6222, "comes apart")])
def test_both_sides_of_the_border_of_the_jigsaw_are_known_to_a_thousandth(gap, verdict):
    """Between them a corner leaves through two necks, one after the other, while others make room: nothing smaller stands for it."""
    drawing = wr.read(HERE.parent / "drawings" / "pyjigsaw_4x5.svg", gap=1.0).drawing
    assembly = assemble(drawing, gap=gap)
    found = interlock(assembly, EscapeEffort(40_000, 40), every=False, context=UNLIMITED)
    assert (found.verdict, found.certainty) == (verdict, "proven")
    assert deepest(assembly, found, 4) < 1e-9 * assembly.size**2
    assert away(assembly, found)


def test_interlocked_says_how_far_at_most():
    """The distance that is stated lies above every motion that is found, in any direction and at any corner."""
    made = wr.patterns.chain(4, joint="tee", gap=0.02)
    found = wr.check(made)
    assert (found.verdict, found.certainty) == ("interlocked", "proven")
    for direction in ((0, 1), (1, 0), (-1, 1)):
        for corner in ((3.5, 0.5), (3.5, -0.5)):
            answer = wr.flex(made, wr.Pull("b4", direction, point=corner), search=0)
            assert answer.objective <= found.at_most
    assert found.at_most < 1.0
    assert check_result(found).at_most == found.at_most
    assert f"no part gets further than {further(found.at_most)} mm from where it lies" in why(found)
    assert float(further(found.at_most)) >= found.at_most


def test_parts_that_touch_and_one_that_passes_through_a_neighbour():
    row = {name: shapely.box(x, 0, x + 10, 10) for name, x in (("a", 0), ("b", 10), ("c", 20), ("d", 30))}
    parts = [part_at(n, s, (*s.centroid.coords[0], 0.0), n in "ad") for n, s in row.items()]
    found = wr.check(assemble(Drawing(tuple(parts), ignore=(("a", "b"),))))
    assert (found.verdict, found.certainty) == ("comes apart", "searched")
    assert {name for escape in found.escapes for name in escape.parts} == {"b", "c"}


def test_what_comes_apart_gets_anywhere():
    found = wr.check(wr.patterns.chain(2, joint="finger", gap=0.02))
    assert found.at_most is None


def test_what_is_glued_to_what_stands_stays_when_all_others_have_left():
    row = {name: shapely.box(x, 0, x + 8, 8) for name, x in (("wall", 0), ("glued", 10), ("block", 20), ("post", 30))}
    parts = [part_at(n, s, (*s.centroid.coords[0], 0.0), n in ("wall", "post")) for n, s in row.items()]
    assembly = assemble(Drawing(tuple(parts), glue=(("wall", "glued"),)))
    found = wr.check(assembly)
    assert [escape.parts for escape in found.escapes] == [("block",)]
    assert not found.remains
    assert not wr.plan(assembly).remains


def test_without_a_free_space_round_rest_boxes_of_motions_decide(monkeypatch):
    def refuse(*_, **__):
        raise FreeSpaceError("no free space was found")

    monkeypatch.setattr("wiggleroom.disassembly.escape.prepare_walls", refuse)
    held = wr.check(wr.patterns.chain(3, joint="swallowtail", gap=0.02))
    assert (held.verdict, held.certainty) == ("interlocked", "proven")
