"""Pictures: what they must show, at any size, and that nothing is cut off."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from tests.answers import answer, block, grid, row
from wiggleroom.assembly.inventory import inventory
from wiggleroom.drawing.model import Part, Pull, Turn
from wiggleroom.files import write_whole
from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.picture import picture
from wiggleroom.report.pictures.png import png
from wiggleroom.report.pictures.read_picture import picture_of_reading
from wiggleroom.report.pictures.text import text_width
from wiggleroom.search.answer import Answer
from wiggleroom.verdict import Verdict

SVG = "{http://www.w3.org/2000/svg}"


def tree(svg: str) -> ElementTree.Element:
    return ElementTree.fromstring(svg.encode())


def texts(svg: str) -> list[ElementTree.Element]:
    return list(tree(svg).iter(f"{SVG}text"))


def said(svg: str) -> str:
    return "\n".join(t.text or "" for t in texts(svg))


def box(text: ElementTree.Element) -> tuple[float, float, float, float]:
    """Left, top, right, bottom of a text element, by an upper estimate of its width."""
    size, x, y = (float(text.get(k, "0")) for k in ("font-size", "x", "y"))
    wide = text_width(text.text or "", size)
    left = (
        x - wide / 2 if text.get("fill") is None else x - wide if text.get("text-anchor") == "end" else x
    )  # names are centred and take their colour from the group
    return left, y - 0.8 * size, left + wide, y + 0.2 * size


def places(svg: str) -> dict[str, list[tuple[float, float]]]:
    """Where parts are drawn, by the fill or, at rest, the word rest."""
    found: dict[str, list[tuple[float, float]]] = {}
    for group in tree(svg).iter(f"{SVG}g"):
        for use in group.findall(f"{SVG}use"):
            match = re.match(r"translate\((\S+) (\S+)\)", use.get("transform", ""))
            assert match
            kind = group.get("fill", "")
            found.setdefault("rest" if kind == "none" else kind, []).append((float(match[1]), float(match[2])))
    return found


def test_title_verdict_scale_and_command_are_said() -> None:
    svg = picture(row())
    assert tree(svg).findtext(f"{SVG}title") == "b5 moves 0.3 mm in +y"
    for words in ("b5 moves 0.3 mm in +y", "optimal", "gap 0.1 mm", "5 parts", "wiggleroom flex it.json"):
        assert words in said(svg)
    assert "wiggleroom flex it.json" in (tree(svg).findtext(f"{SVG}metadata") or "")
    assert "motion x" not in said(svg)


@pytest.mark.parametrize(("scale", "shift"), [(1e-3, 0.0), (2000.0, 1e6)])
def test_a_picture_does_not_depend_on_size_and_place(scale: float, shift: float) -> None:
    here, there = picture(row()), picture(row(scale=scale, shift=shift * scale))
    for a, b in zip(places(here).values(), places(there).values(), strict=True):
        np.testing.assert_allclose(a, b, atol=0.02)


def test_parts_are_drawn_at_rest_and_moved_to_scale() -> None:
    svg = picture(row(5, lift=0.3))
    seen = places(svg)
    assert len(seen["rest"]) == 5
    assert len(seen[palette.FIXED[0]]) == len(seen[palette.PULLED[0]]) == 1
    pitch = seen["rest"][1][0] - seen["rest"][0][0]
    (x, y), (rest_x, rest_y) = seen[palette.PULLED[0]][0], seen["rest"][4]
    assert rest_y - y == pytest.approx(0.3 * pitch, abs=0.02)  # up in the drawing is up in the picture
    assert x == pytest.approx(rest_x, abs=0.02)
    assert seen[palette.FIXED[0]][0] == seen["rest"][0]


@pytest.mark.parametrize("scale", [0.003, 37.0])
def test_the_scale_bar_is_as_long_as_it_says(scale: float) -> None:
    svg = picture(row(scale=scale))
    match = re.search(r"v5h([\d.]+)v-5.*?>([\d.]+) mm<", svg)
    assert match
    assert match[2].strip("0.") in ("1", "2", "5")
    seen = places(svg)["rest"]
    assert float(match[1]) / float(match[2]) == pytest.approx((seen[1][0] - seen[0][0]) / scale, rel=1e-3)


def test_small_motion_is_magnified_and_says_so() -> None:
    small = row(5, lift=0.002)
    small = replace(small, motion=small.motion * (1, 1, 0))
    svg = picture(small)
    match = re.search(r"motion x (\d+)", said(svg))
    assert match
    assert int(match[1]) in (5, 10, 20, 50, 100, 200)
    seen = places(svg)
    pitch = seen["rest"][1][0] - seen["rest"][0][0]
    lifted = seen["rest"][4][1] - seen[palette.PULLED[0]][0][1]
    assert lifted == pytest.approx(0.002 * int(match[1]) * pitch, abs=0.02)
    assert "motion x" not in said(picture(small, magnify=1))
    assert "motion x 7" in said(picture(small, magnify=7))


def long_words() -> Answer:
    name = "a part with a name that is far too long for any picture " * 3
    parts = [Part(name, (block(),), fixed=True), Part(name + "<&>\x07", (block(),), (1.2, 0.0, 0.0))]
    goals = tuple(Pull(p.name, (0.6, 0.8), (0.1, 0.2)) for p in parts * 5)
    command = f"wiggleroom flex '{'x' * 300}' " + "--pull 'a name:+y' " * 40
    return answer(parts, [(0, 0, 0), (0, 0.2, 0)], goals, 1.25, command=command)


def column() -> Answer:
    parts = [Part(f"c{k}", (block(0.9),), (0.0, float(k), 0.3), fixed=k == 0) for k in range(30)]
    return answer(parts, [(0.1, 0.02 * k, 0.0) for k in range(30)], (Turn("c29", "cw"),), 0.05)


def free() -> Answer:
    parts = [Part("a", (block(3.0, hole=1.5),), fixed=True), Part("b", (block(1.0),))]
    return answer(parts, [(0, 0, 0), (1e4, 0, 0)], (Pull("b", (1, 0)),), None, verdict=Verdict.UNBOUNDED, leaves=("b",))


CASES = {
    "row": row(),
    "two": row(2),
    "grid": grid(12),
    "words": long_words(),
    "column": column(),
    "free": free(),
    "still": answer([Part("a", (block(),), fixed=True)], [(0, 0, 0)], (Pull("a", (1, 0)),), 0.0),
}


def read_picture(case: Answer) -> str:
    drawing = case.assembly.drawing
    return picture_of_reading(case.assembly, inventory(drawing), (), ("nothing is wrong",), command=case.command)


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_text_is_never_cut_off_and_never_overlaps(case: Answer) -> None:
    for svg in (picture(case), read_picture(case)):
        root = tree(svg)
        wide, high = float(root.get("width", "0")), float(root.get("height", "0"))
        boxes = np.array([box(t) for t in texts(svg)])
        assert boxes[:, :2].min() >= 0
        assert boxes[:, 2].max() <= wide
        assert boxes[:, 3].max() <= high
        for k, (left, top, right, bottom) in enumerate(boxes):
            others = boxes[k + 1 :]
            apart = (others[:, 0] >= right) | (others[:, 2] <= left) | (others[:, 1] >= bottom) | (others[:, 3] <= top)
            assert apart.all()


def test_an_unbounded_motion_stays_on_the_page() -> None:
    svg = picture(free())
    assert "nothing stops b in +x" in said(svg)
    assert "leaves: b" in said(svg)
    assert re.search(r"motion x 0\.\d+", said(svg))


def test_names_stand_inside_their_parts() -> None:
    svg = picture(row(5))
    found = {t.text: box(t) for t in texts(svg) if t.get("fill") is None}
    assert set(found) == {"b1", "b2", "b3", "b4", "b5"}
    pitch = places(svg)["rest"][1][0] - places(svg)["rest"][0][0]
    for name, (left, _, right, _) in found.items():
        middle = places(svg)["rest"][int(name[1:]) - 1][0]
        assert middle - 0.5 * pitch < left < right < middle + 0.5 * pitch


def test_text_shows_without_any_font_on_the_machine() -> None:
    from importlib.resources import as_file, files

    from resvg_py import svg_to_bytes

    svg = picture(row())
    drawn = png(svg)
    assert int.from_bytes(drawn[16:20], "big") == 1600
    assert drawn != png(re.sub(r"<text.*?</text>", "", svg))
    style = "svg { font-family: 'Wiggle Sans', sans-serif }"
    with as_file(files("wiggleroom.report") / "fonts" / "wiggle-sans.ttf") as font:
        bare = svg_to_bytes(
            svg_string=svg, width=1600, font_files=[str(font)], skip_system_fonts=True, style_sheet=style
        )
    assert bytes(bare) == drawn  # no font of the system took part


def test_a_picture_of_4096_parts_of_different_shapes_stays_small() -> None:
    case = grid(64)
    svg = picture(case)
    assert len(svg) < 5e6


def test_files_are_written_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    write_whole(path, "one")
    path.chmod(0o640)
    write_whole(path, b"two")
    assert path.read_text() == "two"
    assert path.stat().st_mode & 0o777 == 0o640
    link = tmp_path / "link.txt"
    link.symlink_to(path)
    write_whole(link, "three")
    assert link.is_symlink()
    assert path.read_text() == "three"
    (tmp_path / "busy").mkdir()
    with pytest.raises(OSError, match="busy"):
        write_whole(tmp_path / "busy", "x")
    with pytest.raises(FileNotFoundError):
        write_whole(tmp_path / "none" / "a", "x")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.txt", "busy", "link.txt"]
