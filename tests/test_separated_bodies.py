"""Free bodies in rooms of their own change no answer; those that may meet what is pulled are kept."""

from __future__ import annotations

import pytest
import shapely

import wiggleroom as wr
from tests.flexing import part_at
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.model import Drawing
from wiggleroom.search.separated_bodies import without_separated

ROOM = shapely.box(0, 0, 6, 6).difference(shapely.union_all([shapely.box(1, 1, 5, 1.6), shapely.box(1, 4, 5, 4.6)]))
PEG, PEBBLE = shapely.box(1.1, 1.1, 1.6, 1.5), shapely.box(2.1, 4.1, 2.6, 4.5)


def made(*parts: wr.Part, ignore: tuple = (), glue: tuple = ()) -> Assembly:
    return assemble(Drawing(parts, ignore=ignore, glue=glue, goals=(wr.Pull("peg", (1.0, 0.0)),)), gap=0.0)


def fixed_of(assembly: Assembly) -> dict[str, bool]:
    kept = without_separated(wr.prepare(assembly), assembly.goals)
    return {part.name: part.fixed for part in kept.parts}


def plate(hole: shapely.Geometry = ROOM) -> wr.Part:
    return part_at("plate", hole, fixed=True)


def test_a_body_in_a_room_of_its_own_is_left_out() -> None:
    assembly = made(plate(), part_at("peg", PEG), part_at("pebble", PEBBLE))
    assert fixed_of(assembly) == {"plate": True, "peg": False, "pebble": True}
    alone = wr.flex(made(plate(), part_at("peg", PEG)))
    answer = wr.flex(assembly)
    assert answer.verdict == alone.verdict == "proven"
    assert answer.objective == pytest.approx(alone.objective, rel=1e-7)
    assert answer.at_most == pytest.approx(alone.at_most, rel=1e-7)
    assert not answer.motion[2].any()
    assert answer.assembly.parts[2].fixed is False
    further = wr.flex(wr.prepare(assembly), wr.Pull("peg", (0.0, 1.0)))
    assert further.verdict == "proven"


@pytest.mark.parametrize(
    "case",
    {
        "same room": made(plate(), part_at("peg", PEG), part_at("pebble", shapely.box(3, 1.1, 3.5, 1.5))),
        "a way between the rooms": made(
            plate(ROOM.difference(shapely.box(4.6, 1.1, 4.9, 4.5))), part_at("peg", PEG), part_at("pebble", PEBBLE)
        ),
        "the wall is passed": made(plate(), part_at("peg", PEG), part_at("pebble", PEBBLE), ignore=(("plate", "pebble"),)),
        "glue reaches into both": made(
            plate(), part_at("peg", PEG), part_at("pebble", PEBBLE), part_at("stone", shapely.box(4, 1.1, 4.4, 1.5)),
            glue=(("pebble", "stone"),),
        ),
        "both are pulled": assemble(
            Drawing(
                (plate(), part_at("peg", PEG), part_at("pebble", PEBBLE)),
                goals=(wr.Pull("peg", (1.0, 0.0)), wr.Turn("pebble", "ccw")),
            ),
            gap=0.0,
        ),
        "everybody counts": assemble(
            Drawing((plate(), part_at("peg", PEG), part_at("pebble", PEBBLE)), goals=(wr.Translation(),)), gap=0.0
        ),
    }.items(),
    ids=lambda case: case[0],
)  # fmt: skip
def test_who_may_meet_what_is_pulled_is_kept(case: tuple[str, Assembly]) -> None:
    assembly = case[1]
    assert [part.fixed for part in without_separated(wr.prepare(assembly), assembly.goals).parts] == [
        part.fixed for part in assembly.parts
    ]
