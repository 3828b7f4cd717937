"""Parts that nothing asks about rest where what is asked about leaves them room; the motion of what is asked about stays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import wiggleroom as wr
from wiggleroom.assembly.build import assemble
from wiggleroom.audit.path_audit import audit_path
from wiggleroom.drawing.model import Drawing, Part, Pull, Region
from wiggleroom.search.bystanders import with_bystanders_at_rest

SQUARE = (Region(np.array([[-5.0, -5], [5, -5], [5, 5], [-5, 5]])),)
BASE = Part("base", (Region(np.array([[0.0, 0], [60, 0], [60, 5], [0, 5]])),), fixed=True)


def blocks(**at: tuple[float, float]) -> Drawing:
    """Blocks on a base."""
    return Drawing((BASE, *(Part(name, SQUARE, (x, y, 0.0)) for name, (x, y) in at.items())), gap=0.2)


def moving(answer: wr.Answer) -> set[str]:
    return {
        name for name, one in zip(answer.assembly.names, answer.waypoints.transpose(1, 0, 2), strict=True) if one.any()
    }


def test_neighbours_stay_where_a_part_leaves_beside_them() -> None:
    made = assemble(blocks(a=(10, 10), b=(20, 10), c=(30, 10), d=(30, 20)))
    found = wr.flex(made, Pull("b", (0, 1)), search=0)
    end = np.array([[0, 0, 0], [-60, 3, 0], [0, 200, 0], [90, 1, 0], [30, 90, 0]], float)  # all but the base fly
    path = np.linspace(0, 1, 5)[:, None, None] * end
    wild = replace(found, waypoints=path, motion=path[-1], leaves=("a", "b", "c", "d"))
    assert audit_path(made, path).free
    calm = with_bystanders_at_rest(wild)
    assert moving(calm) == {"b"}
    assert calm.leaves == ("b",)
    np.testing.assert_array_equal(calm.motion, [[0, 0, 0], [0, 0, 0], [0, 200, 0], [0, 0, 0], [0, 0, 0]])


def test_a_part_that_is_in_the_way_goes_no_farther_than_it_must() -> None:
    made = assemble(blocks(low=(20, 10), high=(20, 20), other=(40, 10)))
    path = np.linspace(0, 1, 9)[:, None, None] * np.array([[0, 0, 0], [0, 100, 0], [0, 200, 0], [0, 50, 0]], float)
    found = replace(
        wr.flex(made, Pull("low", (0, 1)), search=0), waypoints=path, motion=path[-1], leaves=("low", "high")
    )
    assert audit_path(made, path).free
    calm = with_bystanders_at_rest(found)
    assert audit_path(made, calm.waypoints).free
    assert moving(calm) == {"low", "high"}  # it cannot leave through the one above it
    np.testing.assert_array_equal(calm.waypoints[:, 1], path[:, 1])


def test_parts_that_hold_and_questions_about_all_parts_stay_as_they_are() -> None:
    chain = wr.patterns.chain(4, joint="tee", gap=0.02)
    found = wr.flex(chain, search=0)
    assert with_bystanders_at_rest(found) is found
    wiggle = wr.flex(chain, wr.Translation(), search=0)
    assert with_bystanders_at_rest(wiggle) is wiggle
