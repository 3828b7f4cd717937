"""Parts drawn tight: locked or moving to first order, with proof; and the blocking graphs for translations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from scipy.spatial import Voronoi

import wiggleroom as wr
from wiggleroom.assembly.loops import placed_regions
from wiggleroom.form_closure.blocking_graph import blocking
from wiggleroom.form_closure.mobility import SelfStress, opening, prove_form_closure, tight_verdict
from wiggleroom.form_closure.point_contacts import point_contacts

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]


def region(outer, *holes):
    return wr.Region(np.array(outer, dtype=float), tuple(np.array(h, dtype=float)[::-1] for h in holes))


def part(name, outer, *holes, at=(0.0, 0.0, 0.0), fixed=False):
    return wr.Part(name, (region(outer, *holes),), at=at, fixed=fixed)


def drawn(*parts, **more):
    return wr.assemble(wr.Drawing(parts, **more))


def box(x0, y0, x1, y1):
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]


def slot(kind):
    """The cases of a table with known truth: a unit square and what stands round it."""
    left, right = part("l", box(-1, 0, 0, 1), fixed=True), part("r", box(1, 0, 2, 1), fixed=True)
    u = [[-1, -1], [2, -1], [2, 1], [1, 1], [1, 0], [0, 0], [0, 1], [-1, 1]]
    surroundings = {
        "u slot": [part("u", u, fixed=True)],
        "through slot": [left, right],
        "closed pocket": [part("frame", box(-1, -1, 2, 2), SQUARE, fixed=True)],
    }[kind]
    return drawn(*surroundings, part("plug", SQUARE))


def spinning_plug(turned=0.0):
    """A hexagon whose corners touch the middles of a larger hexagon's sides: it can spin inside the inscribed circle."""
    angle = np.arange(6) * np.pi / 3
    inner = np.column_stack([np.cos(angle + turned), np.sin(angle + turned)])
    hole = np.column_stack([np.cos(angle + np.pi / 6), np.sin(angle + np.pi / 6)]) / np.cos(np.pi / 6)
    return drawn(part("block", box(-2, -2, 2, 2), hole, fixed=True), part("plug", inner))


def three_sectors():
    """Each pair parts only straight across its border; all three must leave at once, in three directions."""
    shapes = []
    for k in range(3):
        low, high = np.radians(30 + 120 * k), np.radians(150 + 120 * k)
        middle = np.radians(90 + 120 * k)
        shapes.append(shapely.Polygon([(0, 0), *(4 * np.array([np.cos(a), np.sin(a)]) for a in (low, middle, high))]))
    for k in range(3):
        ray, across = (np.array([np.cos(a), np.sin(a)]) for a in np.radians([150 + 120 * k, 240 + 120 * k]))
        tongue = shapely.Polygon([s * ray + t * across for s, t in ((1.5, -0.5), (2.2, -0.5), (2.2, 0.5), (1.5, 0.5))])
        one, other = k, (k + 1) % 3
        shapes[one] = shapely.union(shapes[one], tongue)
        shapes[other] = shapely.difference(shapes[other], tongue)
    return drawn(*(part(f"s{k}", shapely.get_coordinates(s.exterior)[:-1]) for k, s in enumerate(shapes)))


def behind_a_key():
    """The low part sits under a ledge until the tall one has left upwards."""
    ground = [[-1, -1], [3, -1], [3, 2], [2, 2], [2, 0], [0, 0], [0, 1], [1, 1], [1, 2], [-1, 2]]
    return drawn(part("g", ground, fixed=True), part("low", box(0, 0, 1, 1)), part("tall", box(1, 0, 2, 2)))


def tiles(seed, count=40, frame=False):
    """A square cut into convex cells, in an open place or in a closed frame."""
    random = np.random.default_rng(seed)
    points = random.uniform(0, 10, (count, 2))
    mirrored = [
        points,
        *(points * s + o for s, o in (((-1, 1), 0), ((1, -1), 0), ((-1, 1), (20, 0)), ((1, -1), (0, 20)))),
    ]
    cells = Voronoi(np.vstack(mirrored))
    parts = []
    for k in range(count):
        corners = cells.vertices[cells.regions[cells.point_region[k]]]
        hull = shapely.get_coordinates(shapely.convex_hull(shapely.multipoints(corners)))[:-1][::-1]
        parts.append(part(f"t{k}", np.clip(np.round(hull, 9), 0, 10)))
    surround = [part("frame", box(-1, -1, 11, 11), box(0, 0, 10, 10), fixed=True)] if frame else []
    return drawn(*surround, *parts)


def common_area(assembly, motion):
    """Overlap of all parts after a motion, by polygon geometry."""
    shapes, owner = placed_regions([
        replace(p, at=tuple(np.add(p.at, m))) for p, m in zip(assembly.parts, motion, strict=True)
    ])  # fmt: skip
    i, j = shapely.STRtree(shapes).query(shapes)
    keep = owner[i] < owner[j]
    return shapely.area(shapely.intersection(shapes[i[keep]], shapes[j[keep]])).sum()


def begins(assembly, motion):
    """Whether a first-order motion loses its overlap with the square of the step, as a true one does."""
    small, large = common_area(assembly, 1e-4 * motion), common_area(assembly, 1e-3 * motion)
    return small < 1e-8 or small < large / 50


@pytest.mark.parametrize(
    ("kind", "verdict"), [("u slot", "moves"), ("through slot", "moves"), ("closed pocket", "locked")]
)
def test_slots(kind, verdict):
    found = wr.tight_verdict(slot(kind))
    assert found.verdict == verdict
    assert found.verify()
    if kind == "u slot":
        assert found.motion[-1] == pytest.approx([0, 1, 0], abs=1e-9)
    if kind == "through slot":
        assert np.abs(found.motion[-1]) == pytest.approx([0, 1, 0], abs=1e-9)
    assert found.moving == (("plug",) if verdict == "moves" else ())


@pytest.mark.parametrize("turned", [0.0, 2 * np.pi / 3])
def test_a_round_plug_spins(turned):
    assembly = spinning_plug(turned)
    found = wr.tight_verdict(assembly)
    assert len(found.contacts.a) == 6
    assert found.verdict == "moves"
    assert found.verify()
    assert np.abs(found.motion[1]) == pytest.approx([0, 0, 1], abs=1e-6)
    assert common_area(assembly, 0.3 * found.motion) < 1e-12  # it really goes on
    assert blocking(assembly).verdict == "locked"  # no turns in there


def test_parts_that_only_leave_together():
    assembly = three_sectors()
    found = wr.tight_verdict(assembly)
    assert blocking(assembly).verdict == "locked"
    assert found.verdict == "moves"
    assert found.verify()
    apart = found.motion[:, :2] - found.motion[[1, 2, 0], :2]
    across = np.radians([240, 0, 120])
    along = apart[:, 0] * np.sin(across) - apart[:, 1] * np.cos(across)
    assert np.abs(along).max() < 1e-7
    assert np.abs(found.motion[:, 2]).max() < 1e-7
    assert common_area(assembly, 0.2 * found.motion) < 1e-6


def test_a_key():
    found = blocking(behind_a_key())
    assert (found.verdict, found.key) == ("keyed", "tall")
    assert found.moves == ((("tall",), (0.0, 1.0)),)
    assert wr.tight_verdict(behind_a_key()).moving == ("tall",)
    glued = drawn(*behind_a_key().parts, glue=(("low", "tall"),))
    assert blocking(glued).verdict == wr.tight_verdict(glued).verdict[:6] == "locked"


@pytest.mark.parametrize("family", ["tee", "swallowtail", "revolute"])
def test_joints_that_hold_are_locked_whatever_the_gap(family):
    for gap in (0.0, 0.02):
        found = wr.tight_verdict(wr.patterns.chain(3, family, gap))
        assert found.verdict == "locked"
        assert found.verify()
        assert len(found.locks) == 2


def test_convex_tiles_always_come_apart_one_by_one():
    """Guibas and Yao 1980: convex parts can be taken away one after the other in any direction, so no graph has a cycle."""
    assembly = tiles(1)
    found = blocking(assembly)
    assert found.verdict == "moves"
    assert (found.components.max(axis=1) == len(assembly.parts) - 1).all()
    first = wr.tight_verdict(assembly)
    assert first.verdict == "moves"
    assert first.verify()
    assert begins(assembly, first.motion)


def test_convex_tiles_in_a_frame():
    assembly = tiles(1, 25, frame=True)
    found = wr.tight_verdict(assembly)
    assert found.verify()
    assert found.verdict == "locked"
    loose = drawn(*(p for p in assembly.parts if p.name != "t3"))
    moves = wr.tight_verdict(loose)  # some neighbours of the hole are wedges that cannot enter it: both verdicts occur
    assert moves.verify()
    assert moves.verdict == "locked" or begins(loose, moves.motion)


def test_a_proof_that_was_tampered_with_fails():
    found = wr.tight_verdict(tiles(1, 12, frame=True))
    (lock,) = found.locks
    assert prove_form_closure(found.contacts, [lock])
    for k in (0, len(lock.force) // 2):
        force = lock.force.copy()
        force[k] *= 1000  # a small imbalance would prove as much: the check knows how much is harmless
        assert not prove_form_closure(found.contacts, [SelfStress(lock.contact, force)])
        force[k] = -lock.force[k]
        assert not prove_form_closure(found.contacts, [SelfStress(lock.contact, force)])
    assert not prove_form_closure(found.contacts, [])
    assert not prove_form_closure(found.contacts, [SelfStress(lock.contact[1:], lock.force[1:])])
    slide = wr.tight_verdict(slot("through slot"))
    everything = SelfStress(np.arange(len(slide.contacts.a)), np.ones(len(slide.contacts.a)))
    assert not prove_form_closure(slide.contacts, [everything])  # in balance, but of low rank
    assert not replace(slide, motion=slide.motion[:, [1, 0, 2]]).verify()


def test_loose_glued_ignored_and_fixed_parts():
    apart = drawn(part("a", SQUARE, fixed=True), part("b", SQUARE, at=(3, 0, 0)))
    assert wr.tight_verdict(apart).moving == ("b",)
    assert blocking(apart).verdict == "moves"
    pocket = slot("closed pocket")
    free = drawn(*pocket.parts, ignore=(("frame", "plug"),))
    assert wr.tight_verdict(free).verdict == "moves"
    assert wr.tight_verdict(drawn(*slot("u slot").parts, glue=(("u", "plug"),))).verdict == "locked"
    unfixed = drawn(*(replace(p, fixed=False) for p in slot("u slot").parts))
    assert wr.tight_verdict(unfixed).moving == ("plug",)  # the larger part stands
    with pytest.raises(wr.InputError, match="more than 0"):
        tight_verdict(apart, within=-1.0)


def test_drawn_clearance_counts_as_contact_when_asked():
    loose = drawn(part("frame", box(-1, -1, 2, 2), SQUARE, fixed=True), part("plug", box(0.02, 0.02, 0.98, 0.98)))
    assert wr.tight_verdict(loose).verdict == "moves"
    assert wr.tight_verdict(loose, within=0.03).verdict == "locked"


def test_hundreds_of_parts_are_locked():
    assert wr.tight_verdict(wr.patterns.grid(26, 26)).verdict == "locked"
    framed = [part("f", box(-1, -1, 15, 15), box(0, 0, 14, 14), fixed=True)]
    framed += [part(f"s{i}-{j}", SQUARE, at=(i, j, 0)) for i in range(14) for j in range(14)]
    assert wr.tight_verdict(drawn(*framed)).verdict == "locked"


def test_motions_open_contacts_and_never_close_them():
    found = wr.tight_verdict(wr.patterns.grid(5, 4, "finger"))
    assert found.verdict == "moves"
    assert opening(found.contacts, found.motion).min() > -1e-9


def test_far_away_turned_and_in_other_units_it_is_the_same():
    for make, verdict in (
        (three_sectors, "moves"),
        (lambda: slot("closed pocket"), "locked"),
        (spinning_plug, "moves"),
    ):
        parts = make().parts
        c, s, scale = np.cos(0.7), np.sin(0.7), 250.0
        moved = []
        for p in parts:
            x, y = p.at[0] * scale, p.at[1] * scale
            regions = tuple(wr.Region(r.outer * scale, tuple(h * scale for h in r.holes)) for r in p.regions)
            moved.append(replace(p, regions=regions, at=(c * x - s * y + 1e4, s * x + c * y - 7e3, p.at[2] + 0.7)))
        found = tight_verdict(drawn(*moved))
        assert found.verdict == verdict
        assert found.verify()


def test_outward_corners_that_meet_are_no_contact():
    diagonal = drawn(part("a", SQUARE, fixed=True), part("b", SQUARE, at=(1, 1, 0)))
    assert len(point_contacts(diagonal).a) == 0
