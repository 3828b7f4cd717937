# ruff: noqa: E501, RUF005, PT017 (tables of forgeries)
"""Certificates that somebody forged: each one claims too much, or what another drawing or question proves, and must be refused."""

from __future__ import annotations

import copy
import dataclasses
import hashlib
import json
import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import wiggleroom as wr

pytest.importorskip("highspy")
pytest.importorskip("flint")

from wiggleroom.cli.options import QuestionOptions
from wiggleroom.cli.verify_command import drawn_by
from wiggleroom.drawing.writers.assembly_writer import write_assembly
from wiggleroom.verify.ball_arithmetic import Refused
from wiggleroom.verify.certificate_structure import check_structure
from wiggleroom.verify.checker import read_certificate, verify
from wiggleroom.verify.claim import claim_of
from wiggleroom.verify.claim_comparison import difference

Content = dict[str, Any]
Forgery = Callable[[Content], Any]
GAP = 0.02


def sealed(content: Content) -> Content:
    """The certificate with the checksum that belongs to it."""
    rest = {k: v for k, v in content.items() if k != "sha256"}
    return rest | {"sha256": hashlib.sha256(json.dumps(rest).encode()).hexdigest()}


def proof_of(assembly: wr.Assembly, *goals: Any, within: float = 0.05) -> Content:
    """An honest certificate of a question."""
    answer = wr.prove(wr.flex(assembly, list(goals) or None, search=0), within, certify=True)
    return json.loads(json.dumps(answer.bound.certificate))


def four(**changes: Any) -> wr.Drawing:
    """Drawing of a chain of four swallowtails: the first stands, the last is pulled up."""
    return dataclasses.replace(wr.patterns.chain(4, joint="swallowtail", gap=GAP).drawing, **changes)


@pytest.fixture(scope="module")
def chain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """File of that chain."""
    file = tmp_path_factory.mktemp("forgeries") / "chain.json"
    file.write_text(write_assembly(four()))
    return file


@pytest.fixture(scope="module")
def honest() -> Content:
    """Its certificate."""
    return proof_of(wr.assemble(four()), within=0.0005)


@pytest.fixture(scope="module")
def truth() -> float:
    """A motion that is possible: less than this must never be proven."""
    return wr.flex(wr.assemble(four()), search=0).objective


def refusal(content: Content, file: Path | None, **asked: Any) -> str:
    """Why a certificate is refused, empty where it is not; what is quick is looked at first."""
    try:
        check_structure(content)
    except Refused as why:
        return str(why)
    claim = claim_of(content)
    return (
        difference(claim, drawn_by(str(file) if file else None, QuestionOptions(**asked), claim)) or verify(content).why
    )


def put(*path: Any) -> Forgery:
    """Forgery that sets the value at a path, its last entry, to another."""
    *keys, last, value = path

    def change(content: Content) -> None:
        node: Any = content
        for key in keys:
            node = node[key]
        node[last] = value(node[last]) if callable(value) else value

    return change


def forged(content: Content, *forgeries: Forgery) -> Content:
    """A changed copy with its checksum."""
    made = copy.deepcopy(content)
    for change in forgeries:
        made = change(made) or made
    return sealed(made)


def test_the_honest_certificate_is_verified(honest: Content, chain: Path, truth: float) -> None:
    assert refusal(honest, chain) == refusal(honest, chain, gap=GAP, fix=("b1",), pull=("b4:+y",)) == ""
    assert truth <= verify(honest).at_most <= 1.0101 * truth
    assert any(one.get("cuts") for one in steps(honest))


# What was accepted once: true proofs of other questions, whose statement was not compared.


def another_part_stands() -> Content:
    parts = tuple(dataclasses.replace(p, fixed=p.name == "b3") for p in four().parts)
    return proof_of(wr.assemble(four(parts=parts)))


def parts_glued() -> Content:
    return proof_of(wr.assemble(four(glue=(("b2", "b3"),))))


def one_body_of_two_names_and_one_outline() -> Content:
    drawing = four(parts=four().parts[:3], goals=(wr.Pull("b2", (0, 1), (3.0, 0.0)),))
    return forged(proof_of(wr.assemble(drawing)), put("bodies", 1, "parts", ["b2", "b4"]))


def a_slot_filled() -> Content:
    """A triangle more on the last tab leaves it a fifth of its room."""
    made = wr.assemble(four()).parts
    outer, tip = made[3].regions[0].outer, [[-0.60, 0.146], [-0.605, 0.1312], [-0.595, 0.1272]]
    whole = shapely.union_all([shapely.Polygon(outer), shapely.Polygon(tip)])
    ring = shapely.get_coordinates(shapely.orient_polygons(whole))[:-1]
    parts = (*made[:3], dataclasses.replace(made[3], regions=(wr.Region(ring),)))
    return forged(proof_of(wr.assemble(four(parts=parts, gap=0.0))), put("gap", GAP))


def smaller_gap() -> Content:
    return forged(proof_of(wr.assemble(four(), gap=0.002)), put("gap", GAP))


ACCEPTED_ONCE = {
    another_part_stands: "chain.json fixes b1, the certificate does not",
    parts_glued: "the certificate has b2, b3 glued together, chain.json has b2 by itself",
    one_body_of_two_names_and_one_outline: "the certificate has b2, b4 glued together, chain.json has b2 by itself",
    a_slot_filled: "b4 has other outlines in chain.json",
    smaller_gap: "b1 has other outlines in chain.json",
}


@pytest.mark.parametrize("forge", ACCEPTED_ONCE, ids=lambda f: f.__name__)
def test_a_true_proof_of_another_question_is_refused(
    forge: Callable[[], Content], chain: Path, truth: float, tmp_path: Path, command: Any, capsys: Any
) -> None:
    content = forge()
    assert verify(content).proven  # of what it speaks of, not of the drawing
    assert verify(content).at_most < truth
    proof = tmp_path / "proof.json"
    proof.write_text(json.dumps(content))
    assert command("verify", proof, chain) == 1
    out = capsys.readouterr().out
    assert out.startswith(f"not verified: {ACCEPTED_ONCE[forge]}")
    assert out.count("\n") == 1


def test_the_gap_of_a_drawing_that_states_none_is_said(tmp_path: Path, command: Any, capsys: Any) -> None:
    drawing, proof = tmp_path / "chain.svg", tmp_path / "proof.json"
    assert command("make", "chain", "3", "--joint", "swallowtail", "--gap", "0", "-o", tmp_path / "chain.json") == 0
    assert command("convert", tmp_path / "chain.json", drawing) == 0
    options = ["--fix", "b1", "--pull", "b3:+y"]
    assert command("flex", drawing, "--gap", "0.002", *options, "--prove", "0.1", "--certificate", proof) == 0
    capsys.readouterr()
    assert command("verify", proof, drawing) == 0
    out = capsys.readouterr().out
    assert "the gap is 0.002 mm" in out
    assert "stated by the certificate only: that the gap is 0.002 mm" in out
    assert "stated by the certificate only: what is asked (point" in out
    assert command("verify", proof, drawing, "--gap", "0.002", *options) == 0
    assert "stated by the certificate only" not in capsys.readouterr().out
    for other in (["--gap", "0.01"], ["--pull", "b3:-y"], ["--pull", "b2:+y"], ["--fix", "b2"], ["--turn", "b3:ccw"]):
        assert command("verify", proof, drawing, *other) == 1, other
    assert command("verify", proof, drawing, "--objective", "closer") == 2
    assert command("verify", proof, "--unit", "mm") == 2
    assert command("verify", proof, "--gap", "0.01") == 1
    assert command("verify", proof, "--gap", "0.002", "--fix", "b1", "--pull", "b3:+y") == 0
    assert "about the outlines in this file, not compared with a drawing" in capsys.readouterr().out


# Statements changed by hand.


def outline(change: Callable[[np.ndarray], Any], body: int = 1) -> Forgery:
    """Forgery of the outer ring of a body."""
    return put("bodies", body, "polygons", 0, 0, lambda ring: np.asarray(change(np.array(ring))).tolist())


def other_goal(*row: float) -> Forgery:
    return put("goal", [list(row)])


TRIANGLE = [[0.1, 0.1], [0.2, 0.1], [0.1, 0.2]]
UP = [3, 0.0, 1.0, 3.0, 0.0, 0.0]

STATEMENTS: dict[str, tuple[Forgery, ...]] = {
    "nothing fixed": (put("bodies", 0, "fixed", False),),
    "pulled body fixed": (put("bodies", 3, "fixed", True),),
    "another body fixed too": (put("bodies", 1, lambda b: b | {"fixed": True, "low": 0.0, "high": 0.0, "far": 0.0}),),
    "fixed by the number 1": (put("bodies", 1, "fixed", 1),),
    "another stands": (put("bodies", 0, lambda b: b | {"fixed": False, "low": -1.0, "high": 1.0, "far": 1.0}),
        put("bodies", 1, lambda b: b | {"fixed": True, "low": 0.0, "high": 0.0, "far": 0.0})),
    "two bodies in one": (put("bodies", 1, "parts", ["b2", "b3"]), put("bodies", lambda b: [b[0], b[1], b[3]])),
    "a name in two bodies": (put("bodies", 1, "parts", ["b2", "b4"]),),
    "names swapped": (put("bodies", 1, "parts", ["b3"]), put("bodies", 2, "parts", ["b2"])),
    "a name with a zero width space": (put("bodies", 1, "parts", ["b2\u200b"]),),
    "a Cyrillic name": (put("bodies", 3, "parts", ["\u04224"]),),
    "a name with a line end": (put("bodies", 3, "parts", ["b4\nverified: no motion"]),),
    "an empty name": (put("bodies", 3, "parts", [""]),),
    "a name that is a number": (put("bodies", 3, "parts", [4]),),
    "one more part": (put("bodies", lambda b: [*b, copy.deepcopy(b[1]) | {"parts": ["b5"]}]),),
    "one more part in the way": (put("bodies", lambda b: [*b, copy.deepcopy(b[0]) | {"parts": ["wall"]}]),
        put("pairs", lambda p: [*p, [4, 3, *p[0][2:]]])),
    "a body left out": (put("bodies", lambda b: b[:3]), put("goal", 0, 0, 2), put("pairs", lambda p: p[:2])),
    "corners swapped": (outline(lambda r: r[[1, 0, *range(2, len(r))]]),),
    "ring reversed": (outline(lambda r: r[::-1]),),
    "ring begins elsewhere and a corner is gone": (outline(lambda r: np.roll(r, -3, 0)[1:]),),
    "a corner more on an edge": (outline(lambda r: np.insert(r, 3, (r[2] + r[3]) / 2, 0)),),
    "mirrored": (outline(lambda r: (r * [-1, 1] + [2, 0])[::-1]),),
    "moved a little": (outline(lambda r: r + [0, 1e-9]),),
    "larger": (outline(lambda r: r.mean(0) + 1.001 * (r - r.mean(0))),),
    "one corner moved": (outline(lambda r: r + 1e-7 * np.eye(len(r), 2)),),
    "one corner moved of the pulled one": (outline(lambda r: r + 1e-8 * np.eye(len(r), 2), 3),),
    "a triangle in the slot": (put("bodies", 1, "polygons", lambda p: [*p, [TRIANGLE]]),),
    "a hole": (put("bodies", 1, "polygons", 0, lambda p: [*p, [[1.1, 0.1], [1.1, 0.2], [1.2, 0.1]]]),),
    "a hole that runs like an outline": (put("bodies", 1, "polygons", 0, lambda p: [*p, TRIANGLE]),),
    "no outline": (put("bodies", 1, "polygons", []),),
    "an outline of two corners": (outline(lambda r: r[:2]),),
    "an outline that crosses itself to no area": (outline(lambda r: [[0, 0], [1, 1], [1, 0], [0, 1]]),),
    "outlines of two bodies swapped": (
        lambda c: put(
            "bodies",
            lambda b: [b[0], b[1] | {"polygons": b[2]["polygons"]}, b[2] | {"polygons": b[1]["polygons"]}, b[3]],
        )(c),
    ),
    "smaller gap": (put("gap", 0.002),),
    "gap nearly right": (put("gap", GAP * (1 + 1e-9)),),
    "negative gap": (put("gap", -GAP),),
    "pulled to the side": (other_goal(3, 1.0, 0.0, 3.0, 0.0, 0.0),),
    "half the weight": (other_goal(3, 0.0, 0.5, 3.0, 0.0, 0.0),),
    "another point": (other_goal(3, 0.0, 1.0, 2.0, 0.0, 0.0),),
    "another body": (other_goal(2, 0.0, 1.0, 3.0, 0.0, 0.0),),
    "a turn": (other_goal(3, 0.0, 0.0, 3.0, 0.0, 1.0), put("turns", True)),
    "a turn beside the pull": (other_goal(3, 0.0, 1.0, 3.0, 0.0, 0.1),),
    "a second pull back": (put("goal", [UP, [3, 0.0, -0.5, 3.0, 0.0, 0.0]]),),
    "the pull in two halves": (put("goal", [[3, 0.0, 0.5, 3.0, 0.0, 0.0]] * 2),),
    "a pull of the fixed body": (other_goal(0, 0.0, 1.0, 0.0, 0.0, 0.0),),
    "a pull of the last body from behind": (other_goal(-1, 0.0, 1.0, 3.0, 0.0, 0.0),),
    "a pull of true": (put("goal", 0, 0, True),),
    "millimetres called a turn": (put("turns", True),),
    "nothing asked": (put("goal", []),),
    "no weight": (other_goal(3, 0.0, 0.0, 3.0, 0.0, 0.0),),
    "a unit that is a number": (put("turns", 0),),
    "a corner twice": (outline(lambda r: np.insert(r, 3, r[3], 0)),),
    "an outline of nothing": (put("bodies", 1, "polygons", [[]]),),
}  # fmt: skip


@pytest.mark.parametrize("name", STATEMENTS)
def test_a_changed_statement_is_refused(honest: Content, chain: Path, name: str) -> None:
    why = refusal(forged(honest, *STATEMENTS[name]), chain)
    assert why
    assert len(why.splitlines()) == 1
    assert why.isprintable()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"glue": (("b3", "b4"),)}, "has b3 by itself"),
        ({"ignore": (("b2", "b3"),)}, "never collide"),
        ({"goals": (wr.Pull("b4", (0, 1), (2.5, 0.0)),)}, "asks for point (2.5, 0) of b4 in direction +y"),
        ({"goals": (wr.Pull("b4", (0, 1)), wr.Turn("b3"))}, "asks for"),
        ({"goals": (wr.W("b4", (0, 1, 0.1)),)}, "asks for"),
        ({"goals": (wr.Pull("b4", (0, 1), weight=2.0),)}, "2 times point"),
    ],
    ids=["glued", "ignored", "point", "more", "w", "weight"],
)
def test_a_drawing_that_says_more_is_not_the_one(honest: Content, tmp_path: Path, change: dict, said: str) -> None:
    file = tmp_path / "other.json"
    file.write_text(write_assembly(four(**change)))
    assert said in refusal(honest, file)


@pytest.mark.parametrize(
    "asked",
    [
        {"gap": 0.0201}, {"fix": ("b1,b3",)}, {"pull": ("b4:-y",)}, {"pull": ("b3:+y",)},
        {"pull": ("b4:+y@3,0.1",)}, {"pull": ("b4:0.01,1",)}, {"pull": ("b4:+y", "b4:+y")}, {"turn": ("b4:ccw",)},
        {"pull": ("b4:+y",), "turn": ("b4:cw",)},
    ],
    ids=str,
)  # fmt: skip
def test_options_that_say_something_else_are_compared(honest: Content, chain: Path, asked: dict) -> None:
    assert refusal(honest, chain, **asked)
    assert refusal(honest, None, **asked)


# What a certificate may look like at all.

DEEP: Any = {"empty": 0}
for _ in range(400):
    DEEP = {"low": [], "high": [], "turns": [], "cuts": [], "then": [DEEP]}

NUMBERS: dict[str, Any] = {
    "nan": math.nan,
    "infinity": math.inf,
    "huge": 1e301,
    "true": True,
    "null": None,
    "words": "1.0",
    "numpy": np.float64(1.0),
}
PLACES: dict[str, tuple] = {
    "what is stated": ("at_most",),
    "gap": ("gap",),
    "corner": ("bodies", 1, "polygons", 0, 0, 2, 1),
    "high": ("bodies", 2, "high"),
    "direction": ("goal", 0, 2),
    "chord": ("regions", 0, "a", 0, 0, 1),
    "loop's corner": ("regions", 0, "loops", 2, 1, 0, 0),
    "pivot": ("pairs", 0, 3),
}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("number", NUMBERS)
def test_what_is_no_number_is_refused(honest: Content, place: str, number: str) -> None:
    if number == "numpy":
        value: Any = np.float64(honest["at_most"]) if place == "what is stated" else NUMBERS[number]
    else:
        value = NUMBERS[number]
    made = copy.deepcopy(honest)
    put(*PLACES[place], value)(made)
    assert not verify(made).proven
    assert not verify(resealed(made)).proven


def resealed(content: Content) -> Content:
    """With its checksum where it has one."""
    try:
        return sealed(content)
    except TypeError:
        return content


def step(**fields: Any) -> Content:
    """A step of a proof."""
    return RANGES | {"turns": [[-0.2, 0.2]] * 3, "cuts": []} | fields


def best(multipliers: list) -> Content:
    """A proof of one step."""
    return RANGES | {"turns": [[-0.2, 0.2]] * 3, "best": multipliers}


RANGES = {"low": [0.0, -0.5, -0.5, -0.5], "high": [0.0, 0.5, 0.5, 0.5]}
EMPTY = RANGES | {"empty": 0}
NOTHING = [1.0, 0.0, []]
NONE = [0, 0, 0, 0, 0, 0]

FORMS: dict[str, Forgery] = {
    "another format": put("format", "wiggleroom.certificate/1"),
    "no checksum": lambda c: None,
    "a field more": put("note", "trust me"),
    "a field more in a step": put("proof", "done", True),
    "a field of other letters": put("at_m\u03bfst", 0.001),
    "a field that is a number": put(1, 2),
    "no bodies": put("bodies", []),
    "no pairs' list": put("pairs", None),
    "a pair too long": put("pairs", 0, lambda p: [*p, 0.0]),
    "a pair of one body": put("pairs", 0, 1, lambda b: 0),
    "a pair of a body too many": put("pairs", 0, 1, 4),
    "a region too many": put("pairs", 0, 2, 7),
    "no regions": put("regions", []),
    "a chord of three points": put("regions", 0, "a", 0, lambda c: [*c, c[0]]),
    "no loops": put("regions", 0, "loops", []),
    "a seam too few": put("regions", 0, "seams", lambda s: s[:-1]),
    "a track from behind": put("regions", 0, "seams", 1, 0, 0, 0, -1),
    "a chord that is not there": put("regions", 0, "seams", 1, 1, 0, 1, 999),
    "no proof": put("proof", None),
    "a proof too deep": put("proof", DEEP),
    "nothing left of a pair from behind": put("proof", RANGES | {"empty": -1}),
    "empty and best": put("proof", EMPTY | best(NOTHING)),
    "best and cuts": put("proof", step(best=NOTHING)),
    "a force of a pair too many": put("proof", best([1.0, 0.0, [[3, 1, *NONE]]])),
    "a force that is no number": put("proof", best([1.0, 0.0, [[0, math.nan, *NONE]]])),
    "a force too large": put("proof", best([1.0, 0.0, [[0, 2**60, *NONE]]])),
    "a unit without end": put("proof", best([math.inf, 0.0, [[0, 1, *NONE]]])),
    "multipliers of a pair too few": put("proof", best([1.0, 0.0, [[0, 1, *NONE[1:]]]])),
    "a range of a step without end": put("proof", step(low=[0.0, -math.inf, -0.5, -0.5])),
    "turns of pairs too few": put("proof", step(turns=[[-0.2, 0.2]] * 2)),
    "no windows' list": put("windows", None),
    "a cut of no body": put("proof", step(cuts=[[9, 1, -1.0, NOTHING]])),
    "a cut without a side": put("proof", step(cuts=[[3, 0, -1.0, NOTHING]])),
    "a cut with infinite weight": put("proof", step(cuts=[[3, 1, -1.0, [1.0, math.inf, []]]])),
    "a split at nan": put("proof", step(split=[3, math.nan], then=[EMPTY, EMPTY])),
    "a split of three": put("proof", step(split=[3, 0.0, 0.1], then=[EMPTY, EMPTY, EMPTY])),
    "a range turned round": put("bodies", 2, lambda b: b | {"low": b["high"], "high": b["low"]}),
    "a range without end": put("bodies", 2, "high", 1e12),
    "a negative shift": put("bodies", 2, "far", -1.0),
    "a fixed body with a range": put("bodies", 0, "high", 0.1),
    "an empty loop": put("regions", 0, "loops", 1, 1, []),
    "multipliers too few": put("proof", best([1.0, 0.0])),
}  # fmt: skip


@pytest.mark.parametrize("name", FORMS)
def test_another_form_is_refused(honest: Content, name: str) -> None:
    made = copy.deepcopy(honest)
    FORMS[name](made)
    if name == "no checksum":
        del made["sha256"]
    found = verify(made if name == "no checksum" else resealed(made))
    assert not found.proven
    assert found.why.isprintable()


def test_a_proof_that_holds_itself_is_refused(honest: Content) -> None:
    made = copy.deepcopy(honest)
    made["proof"] = step(then=[])
    made["proof"]["then"].append(made["proof"])
    assert not verify(made).proven
    shared: Any = EMPTY
    for _ in range(200):  # as a tree it has 2^200 steps
        shared = step(split=[3, 0.0], then=[shared, shared])
    made["proof"] = shared
    assert not verify(made).proven


TEXTS: dict[str, Callable[[str], str]] = {
    "a second value that is stated": lambda t: t.replace('"at_most":', '"at_most": 0.001, "at_most":', 1),
    "a second value in other letters": lambda t: t.replace('"worth":', '"at\\u005fmost": 0.001, "worth":', 1),
    "a second fixed": lambda t: t.replace('"fixed": false', '"fixed": true, "fixed": false', 1),
    "Infinity": lambda t: t.replace('"worth": ', '"worth": -Infinity, "w": ', 1),
    "a number too long": lambda t: t.replace('"gap": 0.02', '"gap": 0.0200000000000000001', 1),
    "a whole number too long": lambda t: t.replace('"gap": 0.02', '"gap": ' + "1" * 5000, 1),
    "minus nought": lambda t: t.replace('"goal": [[3, ', '"goal": [[-0, ', 1),
    "brackets without end": lambda t: t.replace('"proof":', '"proof": ' + "[" * 100_000, 1),
    "cut off": lambda t: t[: len(t) // 2],
    "nothing": lambda t: "",
}


@pytest.mark.parametrize("name", TEXTS)
def test_another_text_is_refused(honest: Content, name: str) -> None:
    text = json.dumps(honest)
    changed = TEXTS[name](text)
    assert changed != text
    try:
        assert not verify(read_certificate(changed)).proven
    except (Refused, ValueError) as why:
        assert len(str(why).splitlines()) <= 1


# Skins and chords.


def loops(change: Callable[[list], Any]) -> Forgery:
    return put("regions", 0, "loops", change)


def corners(change: Callable[[np.ndarray], Any]) -> Forgery:
    """Forgery of all corners of a region's loops."""
    return loops(lambda rows: [[t, np.asarray(change(np.array(at))).tolist()] for t, at in rows])


def around_rest(content: Content) -> int:
    return next(k for k, (t, _) in enumerate(content["regions"][0]["loops"]) if t == 0)


def without_loop(k: int) -> Forgery:
    def change(content: Content) -> None:
        region = content["regions"][0]
        del region["loops"][k], region["seams"][k]

    return change


def small_surface(content: Content) -> None:
    """A tiny box round rest, drawn by hand; the chords named are some that there are."""
    region = content["regions"][0]
    side = [[1e-4, -1e-4], [1e-4, 1e-4], [-1e-4, 1e-4], [-1e-4, -1e-4]]
    region["loops"] = [[-1e-4, [[0.0, 0.0]]], [0.0, side], [1e-4, [[0.0, 0.0]]]]
    round_ = [[0, k % 4] for k in range(5)]
    named = [[0, 0]] * 4
    region["seams"] = [[round_, named], [[[k, 0] for _, k in round_], named]]


def small_surface_of(chords: Callable[[np.ndarray], Any]) -> Forgery:
    """The same, with chords that cross at rest: so long that they must."""

    def change(content: Content) -> None:
        small_surface(content)
        region = content["regions"][0]
        region["a"] = [[[-9.0, 0.0], [9.0, 1e-9]]]
        region["b"] = chords(np.array([[[0.0, -9.0], [1e-9, 9.0]]])).tolist()

    return change


SKINS: dict[str, Forgery] = {
    "smaller": corners(lambda at: 0.9 * at),
    "a hair smaller": corners(lambda at: (1 - 1e-6) * at),
    "a point": corners(lambda at: 0 * at),
    "moved": corners(lambda at: at + [0.01, 0.0]),
    "mirrored": corners(lambda at: at * [-1, 1]),
    "flattened": corners(lambda at: at * [1, 0.5]),
    "fewer turns": loops(lambda rows: [[0.9 * t, at] for t, at in rows]),
    "turns backwards": loops(lambda rows: [[-t, at] for t, at in rows]),
    "two loops at rest": loops(lambda rows: [[0.0 if k == 1 else t, at] for k, (t, at) in enumerate(rows)]),
    "open at the first end": loops(lambda rows: [[rows[0][0], [[-9.0, -9.0], [9.0, -9.0], [0.0, 9.0]]], *rows[1:]]),
    "the second loop left out": without_loop(1),
    "the loop at rest left out": lambda c: without_loop(around_rest(c))(c),
    "the last loop left out": put("regions", 0, lambda r: r | {"loops": r["loops"][:-1], "seams": r["seams"][:-1]}),
    "only the half above rest": put("regions", 0, lambda r: r | {"loops": [[t, a] for t, a in r["loops"] if t >= 0], "seams": r["seams"][-sum(t > 0 for t, _ in r["loops"]):]}),
    "a seam without pieces": put("regions", 0, "seams", 1, lambda s: [s[0][:1], []]),
    "a seam the other way round": put("regions", 0, "seams", 1, lambda s: [s[0][::-1], s[1][::-1]]),
    "a corner left out of a seam": put("regions", 0, "seams", 1, lambda s: [[s[0][0], *s[0][2:]], s[1][1:]]),
    "chords exchanged": put("regions", 0, "seams", 1, lambda s: [s[0], [s[1][k - 1] for k in range(len(s[1]))]]),
    "chords of a and b exchanged": put("regions", 0, lambda r: r | {"a": r["b"], "b": r["a"]}),
    "longer chords": put("regions", 0, "a", lambda rows: [[(2 * np.array(p) - q).tolist(), (2 * np.array(q) - p).tolist()] for p, q in rows]),
    "chords that stick out": put("regions", 0, "a", lambda rows: [[[1.02 * x, 1.02 * y] for x, y in row] for row in rows]),
    "chords a hair outside": put("regions", 0, "a", lambda rows: [[[x, y + (2e-8 if y < 0 else -2e-8)] for x, y in row] for row in rows]),
    "no chords": put("regions", 0, lambda r: r | {"a": [], "b": []}),
    "a tiny surface": small_surface,
    "a tiny surface of long chords": small_surface_of(lambda b: b),
    "a pivot moved": put("pairs", 1, 3, lambda x: x + 0.01),
    "a pair turned": put("pairs", 1, 5, 0.1),
    "a pair the other way round": put("pairs", 1, lambda p: [p[1], p[0], *p[2:]]),
    "a pair of bodies far apart": put("pairs", lambda p: [*p, [0, 3, *p[0][2:]]]),
    "a pair that skips a body": put("pairs", 1, 0, 0),
    "all pairs the same": put("pairs", lambda p: [p[0]] * 3),
}  # fmt: skip


HARMLESS = {"a hair smaller", "the second loop left out"}
"""What is left is still shut: chords lie deep enough behind the edges, and turns close enough to each other."""


@pytest.mark.parametrize("name", SKINS)
def test_a_changed_skin_proves_nothing_false(honest: Content, truth: float, name: str) -> None:
    """Refused as it stands; and with the value that it would like to prove."""
    low = put("at_most", 0.5 * truth), put("worth", 0.5 * truth)
    assert name in HARMLESS or not verify(forged(honest, SKINS[name])).proven
    assert not verify(forged(honest, SKINS[name], *low)).proven


# Multipliers and the tree of the proof: each together with a value below what is possible.


def steps(content: Content) -> list[Content]:
    found, todo = [], [content["proof"]]
    while todo:
        found.append(todo.pop())
        todo += found[-1].get("then", [])
    return found


def in_all(change: Callable[[Content], Any]) -> Forgery:
    """Forgery of every step."""

    def forge(content: Content) -> None:
        for one in steps(content):
            change(one)

    return forge


def multipliers(change: Callable[[list], None]) -> Forgery:
    """Forgery of all multipliers."""

    def forge(one: Content) -> None:
        for row in [one["best"]] if "best" in one else [cut[3] for cut in one.get("cuts", [])]:
            change(row)

    return in_all(forge)


def scaled(*factors: int, goal: float = 1.0, unit: float = 1.0) -> Forgery:
    """Forgery of force (x, y), moment, both slopes, both couplings and the curvature."""

    def change(row: list) -> None:
        row[0] *= unit
        row[1] *= goal
        if factors:
            row[2] = [[p, *(f * v for f, v in zip(factors, whole, strict=True))] for p, *whole in row[2]]

    return multipliers(change)


def first_cut(content: Content) -> list:
    return next(one["cuts"][0] for one in steps(content) if one.get("cuts"))


def cut(**fields: Any) -> Forgery:
    """Forgery of the first cut that there is."""

    def forge(content: Content) -> None:
        found = first_cut(content)
        for key, value in fields.items():
            place = ("body", "sign", "end", "multipliers").index(key)
            found[place] = value(found[place]) if callable(value) else value

    return forge


PROOFS: dict[str, Forgery] = {
    "as it is": lambda c: None,
    "no multipliers": put("proof", best(NOTHING)),
    "forces the other way": scaled(-1, -1, 1, 1, 1, 1, 1, 1),
    "moments the other way": scaled(1, 1, -1, 1, 1, 1, 1, 1),
    "slopes the other way": scaled(1, 1, 1, -1, -1, 1, 1, 1),
    "couplings the other way": scaled(1, 1, 1, 1, 1, -1, -1, 1),
    "curvatures the other way": scaled(1, 1, 1, 1, 1, 1, 1, -1),
    "couplings exchanged": multipliers(lambda row: row.__setitem__(2, [[*r[:6], r[7], r[6], *r[8:]] for r in row[2]])),
    "all the other way": scaled(unit=-1.0),
    "a negative weight of the goal": scaled(goal=-1.0),
    "pairs twice named": multipliers(lambda row: row[2].extend(copy.deepcopy(row[2]))),
    "multipliers of other pairs": multipliers(lambda row: row.__setitem__(2, [[(r[0] + 1) % 3, *r[1:]] for r in row[2]])),
    "narrow ranges of steps": in_all(lambda s: s.update(low=[v / 2 for v in s["low"]], high=[v / 2 for v in s["high"]])),
    "narrow turns of pairs": in_all(lambda s: s.update(turns=[[a / 2, b / 2] for a, b in s["turns"]]) if "turns" in s else None),
    "nothing left at once": put("proof", EMPTY),
    "no cuts and nothing after": put("proof", step()),
    "a split with both sides empty": put("proof", step(split=[3, 0.0], then=[EMPTY, EMPTY])),
    "a split beyond the range": put("proof", step(split=[3, 1e5], then=[EMPTY, EMPTY])),
    "a split of the fixed body": put("proof", step(split=[0, -1.0], then=[EMPTY, EMPTY])),
    "a split at the end": lambda c: put("proof", step(split=[3, c["bodies"][3]["high"]], then=[EMPTY, EMPTY]))(c),
    "a cut that nobody proves": put("proof", step(cuts=[[3, 1, -10.0, NOTHING]])),
    "a cut of the fixed body": put("proof", step(cuts=[[0, 1, -1e-9, NOTHING]])),
    "a proof cut short": lambda c: put("proof", lambda p: p["then"][0] if p.get("then") else EMPTY)(c),
    "a deeper cut": cut(end=lambda e: 0.5 * e),
    "a cut of the other side": cut(sign=lambda s: -s),
    "a cut of another body": cut(body=lambda b: 1 if b != 1 else 2),
    "narrow first ranges": lambda c: [b.update(low=0.1 * b["low"], high=0.1 * b["high"]) for b in c["bodies"]] and None,
    "no first range": put("bodies", 3, lambda b: b | {"low": 0.0, "high": 0.0, "far": 0.0}),
    "a short first shift": put("bodies", 3, "far", lambda f: 0.5 * f),
    "nothing known of the pulled body": put("bodies", 3, lambda b: b | {"low": None, "high": None, "far": None}),
    "an origin moved": put("bodies", 3, "origin", lambda o: [o[0] + 0.1, o[1]]),
    "no pairs": put("pairs", []),
    "the last pair left out": put("pairs", lambda p: p[:-1]),
    "a goal of nearly nothing": put("goal", 0, 2, 1e-9),
}  # fmt: skip


@pytest.mark.parametrize("share", [0.999, 0.5])
@pytest.mark.parametrize("name", PROOFS)
def test_nothing_proves_less_than_what_is_possible(
    honest: Content, chain: Path, truth: float, name: str, share: float
) -> None:
    low = put("at_most", share * truth), put("worth", share * truth)
    assert refusal(forged(honest, PROOFS[name], *low), chain)


def test_a_split_needs_both_sides(honest: Content) -> None:
    whole = honest["proof"]
    for middle in (-0.1, 0.0, 0.1):
        assert verify(forged(honest, put("proof", step(split=[3, middle], then=[whole, copy.deepcopy(whole)])))).proven
        for then in ([whole, EMPTY], [EMPTY, whole], [whole], [EMPTY, EMPTY], [whole, step(then=[EMPTY])], []):
            assert not verify(forged(honest, put("proof", step(split=[3, middle], then=then)))).proven


# Windows.


@pytest.fixture(scope="module")
def windowed() -> Content:
    """Certificate of a small grid whose proof looks at windows first and then at one neighbourhood after the other."""
    return grid_with_windows("tee", within=0.01)


@pytest.fixture(scope="module")
def narrowing() -> Content:
    """The same of blocks whose windows narrow the turn of single joints too."""
    return grid_with_windows("swallowtail", within=0.2)


def grid_with_windows(joint: str, within: float) -> Content:
    """Certificate of nine blocks that are proven as very many are."""
    from wiggleroom.bound import branch_and_bound, neighbourhood_tightening

    made = wr.patterns.grid(3, 3, joint=joint, gap=GAP)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(branch_and_bound, "MANY_BODIES", 4)
        patch.setattr(branch_and_bound, "MAX_WHOLE_BODIES", 4)
        patch.setattr(neighbourhood_tightening, "REACH", 2)
        return proof_of(made, wr.Pull(made.names[-1], (0, 1)), within=within)


def in_window(change: Callable[[Content], Any]) -> Forgery:
    """Forgery of the first window."""

    def forge(content: Content) -> None:
        change(content["windows"][0])

    return forge


WINDOWS: dict[str, Forgery] = {
    "half the range": in_window(lambda w: w.update(low=[v / 2 for v in w["low"]], high=[v / 2 for v in w["high"]])),
    "a range beside rest": in_window(lambda w: w.update(low=[0.0, *[1e-9] * 3])),
    "no steps": in_window(lambda w: w.update(steps=[])),
    "deeper cuts": in_window(lambda w: [c.__setitem__(2, c[2] / 2) for s in w["steps"] for c in s["cuts"]]),
    "no multipliers": in_window(lambda w: [c.__setitem__(3, NOTHING) for s in w["steps"] for c in s["cuts"]]),
    "a weight of the goal": in_window(lambda w: [c[3].__setitem__(1, 1e6) for s in w["steps"] for c in s["cuts"]]),
    "no first ranges": in_window(lambda w: w["steps"][0].update(low=[0.0] * 4, high=[0.0] * 4)),
    "another body stands": in_window(lambda w: [p.reverse() for p in w["placements"]]),
    "a placement that is not alike": in_window(lambda w: w["placements"][1].reverse()),
    "a body twice": in_window(lambda w: w["placements"][1].__setitem__(1, w["placements"][1][2])),
    "joints of another window": in_window(lambda w: w["pairs"].__setitem__(1, w["pairs"][2])),
    "fewer joints": in_window(lambda w: w.update(pairs=[p[:1] for p in w["pairs"]])),
    "a joint moved": put("pairs", 5, 3, lambda x: x + 0.01),
    "more placements than joints": in_window(lambda w: w["placements"].append(w["placements"][0])),
}  # fmt: skip


def test_a_certificate_with_windows_is_verified(windowed: Content) -> None:
    assert len(windowed["windows"]) >= 2
    assert all(len(w["placements"]) == 4 for w in windowed["windows"][:2])
    assert verify(windowed).proven
    # where a body has its origin says nothing of where it lies
    assert verify(forged(windowed, put("bodies", 4, "origin", lambda o: [o[0] + 0.01, o[1]]))).proven


@pytest.mark.parametrize("name", WINDOWS)
def test_windows_that_are_forged_are_refused(windowed: Content, name: str) -> None:
    assert not verify(forged(windowed, WINDOWS[name])).proven


def test_what_one_placement_alone_knows_is_refused(windowed: Content) -> None:
    """Two joints in a row stand alike in two places, in one of them in a ring that is looked at: what that shows does not hold of both."""
    pairs, ring = windowed["pairs"], windowed["windows"][0]
    bodies, joints = ring["placements"][0], ring["pairs"][0]
    joined = {frozenset(pairs[p][:2]): k for k, p in enumerate(joints)}
    last = next(k for k in (1, 2, 3) if frozenset((bodies[0], bodies[k])) not in joined)
    middle = next(k for k in (1, 2, 3) if k != last)
    row = [0, middle, last]
    own = [joined[frozenset((bodies[k], bodies[middle]))] for k in (0, last)]
    turns = [[loops[0][0], loops[-1][0]] for loops in (windowed["regions"][pairs[joints[k]][2]]["loops"] for k in own)]
    low, high = ([1.000001 * ring[key][k] for k in row] for key in ("low", "high"))
    assert high[2] < 0.99 * sum(most for _, most in turns)
    step = {"low": low, "high": high, "turns": turns, "cuts": []}
    window = {"far": [0.0, 10.0, 10.0], "low": low, "high": high, "steps": [step]}
    first = ring | {"placements": [bodies], "pairs": [joints]}

    def why(*places: int) -> str:
        rows = {
            "placements": [[ring["placements"][n][k] for k in row] for n in places],
            "pairs": [[ring["pairs"][n][k] for k in own] for n in places],
        }
        return verify(forged(windowed, put("windows", [first, window | rows]))).why

    assert "window" not in why(0)
    assert "nothing shows that body 2 of a window" in why(0, 1)


def test_what_windows_show_of_single_joints_is_used(narrowing: Content) -> None:
    assert narrowed_joint(narrowing)
    assert verify(narrowing).proven


def test_what_one_placement_alone_knows_of_a_joint_is_refused(narrowing: Content) -> None:
    """A joint stands alike in two places, in one of them in a ring that is looked at: what that shows does not hold of both."""
    ring, joint, other, wide = narrowed_joint(narrowing)
    low, high = ([0.0, 1.000001 * ring[key][other]] for key in ("low", "high"))
    step = {"low": low, "high": high, "turns": [[low[1], high[1]]], "cuts": []}
    window = {"far": [0.0, 10.0], "low": [-0.0, 2 * low[1]], "high": [0.0, 2 * high[1]], "steps": [step]}
    first = ring | {"placements": ring["placements"][:1], "pairs": ring["pairs"][:1]}

    def why(*places: int) -> str:
        rows = {
            "placements": [[ring["placements"][n][k] for k in (0, other)] for n in places],
            "pairs": [[ring["pairs"][n][joint]] for n in places],
        }
        before = [k for k in narrowing["windows"] if k is not ring][:1]
        return verify(forged(narrowing, put("windows", [*before, first, window | rows]))).why

    assert "window" not in why(0)
    assert "nothing shows that body 1 of a window" in why(0, 1)
    step |= {"low": [0.0, 2 * wide[0]], "high": [0.0, 2 * wide[1]]}  # so only the pair's own turn says too much
    assert "window" not in why(0)
    assert "nothing shows that a pair stays within its range" in why(0, 1)


def narrowed_joint(content: Content) -> tuple[dict[str, Any], int, int, list[float]] | None:
    """A window, a joint by its place there, the place of its other body, and what its region says: the window says less of its turn."""
    for window in content["windows"]:
        bodies = window["placements"][0]
        for k, p in enumerate(window["pairs"][0]):
            a, b, kind, *_ = content["pairs"][p]
            loops = content["regions"][kind]["loops"]
            if a == bodies[0] and window["low"][bodies.index(b)] > 0.99 * loops[0][0]:
                return window, k, bodies.index(b), [loops[0][0], loops[-1][0]]
    return None


def in_step(change: Callable[[Content], Any]) -> Forgery:
    """Forgery of all steps that are about multipliers of the whole."""

    def forge(content: Content) -> None:
        for step in steps(content):
            if "base" in step:
                change(step)

    return forge


BASES: dict[str, Forgery] = {
    "no base": in_step(lambda s: s.pop("base")),
    "twice the base": in_step(lambda s: s["base"].__setitem__(0, 2 * s["base"][0])),
    "the base the other way": in_step(lambda s: [r.__setitem__(k, -r[k]) for r in s["base"][2] for k in range(1, 9)]),
    "a pair of no body": in_step(lambda s: s["base"][2].append([99] + [0] * 8)),
    "a negative weight": in_step(lambda s: [c[3].__setitem__(1, -1.0) for c in s["cuts"]]),
    "a base in a window": in_window(lambda w: w["steps"][0].update(base=NOTHING)),
    "a pair of the base twice": in_step(lambda s: s["base"][2].append(s["base"][2][0])),
}  # fmt: skip


def test_steps_about_multipliers_of_the_whole_are_verified(windowed: Content) -> None:
    assert any(s.get("base") and s["cuts"] for s in steps(windowed))


@pytest.mark.parametrize("name", BASES)
def test_a_forged_base_is_refused(windowed: Content, name: str) -> None:
    assert not verify(forged(windowed, BASES[name])).proven


# Work.


@pytest.mark.slow
def test_time_grows_with_the_file_and_no_faster(honest: Content) -> None:
    """Few numbers that ask for much: all pairs of a body with very many corners, and of a region with very many chords."""
    took = []
    for times in (1, 4):
        made = copy.deepcopy(honest)
        ring = made["bodies"][1]["polygons"][0][0]
        edge = np.linspace(ring[0], ring[1], 1500 * times, endpoint=False)
        made["bodies"][1]["polygons"][0][0] = [*edge.tolist(), *ring[1:]]
        more = 500 * times
        made["pairs"] += [made["pairs"][1]] * more
        for step in (s for s in steps(made) if "turns" in s):
            step["turns"] += [step["turns"][1]] * more
        made = sealed(made)
        begin = time.process_time()
        found = verify(made)
        took.append((time.process_time() - begin) / len(json.dumps(made)))
        assert "more work" in found.why or found.at_most >= honest["at_most"]
    assert took[1] < 3 * took[0]


def test_honest_work_is_far_below_the_limit(honest: Content, monkeypatch: pytest.MonkeyPatch) -> None:
    from wiggleroom.verify import work_limit

    monkeypatch.setattr(work_limit, "STEPS", work_limit.STEPS // 10)
    assert verify(honest).proven
