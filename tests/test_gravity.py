"""Who falls and who must be held, against cases that statics decides by hand."""

import json

import numpy as np
import pytest
import shapely
from benchmarks.plan_families import assembled

import wiggleroom as wr
from wiggleroom.planning.gravity import Gravity
from wiggleroom.planning.planar_plan_geometry import PlanarFalling
from wiggleroom.search.prepare import survey

FLOOR = shapely.box(-40, -10, 40, 0)
DOWN = (0.0, -1.0)


def falls(parts, direction=DOWN, fixed="floor", gap=0.4):
    """Names of the parts that fall from rest when nobody holds anything."""
    assembly = assembled(parts, fixed, gap)
    n = len(assembly.parts)
    none, there = np.zeros(n, dtype=bool), np.ones(n, dtype=bool)
    fallen = Gravity(PlanarFalling(assembly, survey(assembly)), direction).falling(np.zeros((n, 3)), there, none)
    return {name for name, f in zip(assembly.names, fallen, strict=True) if f}


def stack(count, shift=0.0):
    return {f"b{k + 1}": shapely.box(shift * k - 5, 10 * k, shift * k + 5, 10 * k + 10) for k in range(count)}


@pytest.mark.parametrize("count", [1, 3, 6])
def test_a_stack_stands_and_falls_upwards(count):
    assert falls({"floor": FLOOR, **stack(count)}) == set()
    assert falls({"floor": FLOOR, **stack(count)}, (0.0, 1.0)) == set(stack(count))


def test_blocks_beside_the_floor_fall():
    assert falls({"floor": FLOOR, "on": shapely.box(-5, 0, 5, 10), "off": shapely.box(41, -5, 50, 5)}) == {"off"}


@pytest.mark.parametrize("begin", [-8, -5, -1, 3])
def test_a_beam_tips_where_its_centroid_is_beyond_its_support(begin):
    # 16 long, on a block from -5 to 5: it stays as long as its middle does
    parts = {"floor": FLOOR, "block": shapely.box(-5, 0, 5, 10), "beam": shapely.box(begin, 10, begin + 16, 14)}
    assert falls(parts, gap=0.1) == (set() if begin + 8 < 5 else {"beam"})


@pytest.mark.parametrize("height", [10, 24, 40, 60])
def test_a_counterweight_holds_a_beam(height):
    # moments about the edge of the block, at 5: the beam's 16 * 4 by 4 against the weight's 4 * height by 2
    parts = {"floor": FLOOR, "block": shapely.box(-5, 0, 5, 10), "beam": shapely.box(1, 10, 17, 14)}
    parts["weight"] = shapely.box(1, 14, 5, 14 + height)
    assert falls(parts, gap=0.1) == ({"beam"} if 4 * height * 2 < 16 * 4 * 4 else set())


def test_a_dovetail_hangs_and_a_peg_drops():
    notch = shapely.Polygon([(-4, 0), (4, 0), (6, 8), (-6, 8)])
    body = shapely.box(-10, -10, 10, 0)
    beam = shapely.box(-20, 0, 20, 20)
    assert falls({"beam": beam - notch, "tail": notch | body}, fixed="beam") == set()
    peg = shapely.box(-4, 0, 4, 8)
    assert falls({"beam": beam - peg, "tail": peg | body}, fixed="beam") == {"tail"}


def test_a_keystone_is_held_up_by_its_abutments():
    # walls stand behind both abutments; a wedge that is wider above rests between them, one that is wider below drops
    floor = FLOOR | shapely.box(-40, 0, -30, 30) | shapely.box(30, 0, 40, 30)
    for above, below, dropped in ((10, 6, set()), (6, 10, {"key"})):
        key = shapely.Polygon([(-below, 10), (below, 10), (above, 20), (-above, 20)])
        opening = shapely.Polygon([(-2 * below + above, 0), (2 * below - above, 0), (above, 20), (-above, 20)])
        left, right = shapely.box(-30, 0, 0, 20) - opening, shapely.box(0, 0, 30, 20) - opening
        assert falls({"floor": floor, "left": left, "right": right, "key": key}) == dropped


def shelf():
    """Two blocks, one on the other, on a plate that is pulled out to the right; a wall on their left and one on their right."""
    frame = shapely.box(-30, -20, 40, 40) - shapely.box(-6, -10, 6, 40) - shapely.box(-20, -5, 40, 0)
    return {
        "frame": frame,
        "plate": shapely.box(-20, -5, 30, 0),
        "low": shapely.box(-6, 0, 6, 10),
        "top": shapely.box(-6, 10, 6, 20),
    }


def test_only_the_lower_one_is_held_while_the_plate_goes():
    found = wr.plan(assembled(shelf(), "frame", gap=0.4), ["plate"], gravity=DOWN)
    assert [step.parts for step in found.steps] == [("plate",)]
    assert found.steps[0].falling == ("low",)
    sideways = wr.plan(assembled(shelf(), "frame", gap=0.4), ["plate"], gravity=(1.0, 0.0))
    assert sideways.steps[0].falling == ()


def test_steps_of_a_stack_need_no_hand_and_upside_down_they_do():
    found = wr.plan(assembled({"floor": FLOOR, **stack(3)}, "floor"), gravity=DOWN)
    assert [step.falling for step in found.steps] == [(), (), ()]
    upside_down = wr.plan(assembled({"floor": FLOOR, **stack(2)}, "floor"), gravity=(0, 1))
    assert [(step.parts, step.falling) for step in upside_down.steps] == [(("b2",), ("b1",)), (("b1",), ())]


def test_command(command, tmp_path, capsys):
    from wiggleroom.drawing import write_drawing

    source = tmp_path / "shelf.json"
    write_drawing(assembled(shelf(), "frame", gap=0.4).drawing, source)
    assert command("plan", source, "--target", "plate", "--gravity", "-y", "--json", tmp_path / "plan.json") == 0
    assert "hold low" in capsys.readouterr().out
    told = json.loads((tmp_path / "plan.json").read_text())
    assert told["gravity"] == [0.0, -1.0]
    assert told["steps"][0]["falling"] == ["low"]
    assert "low" in told["steps"][0]["held"]
    assert command("plan", source, "--gravity", "down") == 2
    assert "--gravity down" in capsys.readouterr().err


def test_what_rests_on_others_leaves_before_them():
    cabinet = shapely.box(0, 0, 30, 40) - shapely.box(4, 4, 40, 36)
    drawers = {"shelf": shapely.box(4, 14, 28, 18), "low": shapely.box(4, 4, 26, 14), "up": shapely.box(4, 18, 26, 36)}
    assembly = assembled({"cabinet": cabinet, **drawers}, "cabinet", 0.4)
    blind, found = wr.plan(assembly), wr.plan(assembly, gravity=DOWN)
    weight = Gravity(PlanarFalling(assembly, survey(assembly)), DOWN)
    assert any(weight.to_hold(step) for step in blind.steps)
    assert found.order == (("up",), ("shelf",), ("low",))
    assert not any(step.falling for step in found.steps)


def test_a_slope_without_friction_lets_go():
    slope = shapely.Polygon([(-40, -10), (40, -10), (40, 10), (-40, -2)])
    angle = float(np.arctan2(12, 80))
    block = shapely.affinity.rotate(shapely.box(-5, 0, 5, 8), angle, origin=(0, 0), use_radians=True)
    block = shapely.affinity.translate(block, 0, 4)
    assert falls({"floor": slope, "block": block}, gap=0.1) == {"block"}
