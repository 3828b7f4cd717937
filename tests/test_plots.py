"""Plots and colours: what is drawn must be as large as the numbers say."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest

import wiggleroom as wr
from wiggleroom.report.finding import Bars, Curve, Histogram
from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.plots import Heading, bars, curve, histogram
from wiggleroom.report.pictures.text import text_width

TITLE, XY = Heading("t"), ("x", "y")
SVG = "{http://www.w3.org/2000/svg}"


def all_of(svg: str, tag: str) -> list[ElementTree.Element]:
    return list(ElementTree.fromstring(svg.encode()).iter(f"{SVG}{tag}"))


def axis(svg: str, *, of_x: bool) -> tuple[float, float]:
    """Pixels per unit and the place of 0 on an axis, from its numbers and their lines."""
    found = []
    for text in all_of(svg, "text"):
        if text.get("anchor", text.get("text-anchor")) == ("middle" if of_x else "end") and re.fullmatch(
            r"-?[\d.]+", text.text or ""
        ):
            place = float(text.get("x", "0")) if of_x else float(text.get("y", "0")) - 5
            found.append((float(text.text or "0"), place))
    values, places = np.array(found).T
    scale, zero = np.polyfit(values, places, 1)
    np.testing.assert_allclose(scale * values + zero, places, atol=0.1)
    return float(scale), float(zero)


@pytest.mark.parametrize("size", [1e-5, 1.0, 3e4])
def test_points_lie_where_the_numbers_on_the_axes_say(size: float) -> None:
    x, y = np.array([0.1, 0.25, 0.6, 0.9]), np.array([0.3, 1.7, -0.4, 2.2]) * size
    svg = curve(Curve(x, y, ("gap mm", "motion mm")), TITLE)
    dots = np.array([[float(c.get("cx", "0")), float(c.get("cy", "0"))] for c in all_of(svg, "circle")])
    for k, values in enumerate((x, y)):
        scale, zero = axis(svg, of_x=k == 0)
        np.testing.assert_allclose((dots[:, k] - zero) / scale, values, atol=2e-3 * np.ptp(values))


def test_a_curve_breaks_where_there_is_no_value() -> None:
    svg = curve(Curve(np.arange(5.0), np.array([1.0, 2.0, np.nan, np.inf, 3.0]), XY), TITLE)
    assert len(all_of(svg, "circle")) == 3
    (line,) = [p.get("d", "") for p in all_of(svg, "path") if p.get("stroke-width") == "2.5"]
    assert (line.count("M"), line.count("L")) == (2, 1)


def test_a_histogram_counts_every_finite_value_once() -> None:
    values = np.concatenate([np.random.default_rng(1).normal(2.0, 0.1, 500), [np.inf, np.nan]])
    svg = histogram(Histogram(values, "motion mm"), TITLE)
    scale, _ = axis(svg, of_x=False)
    boxes = [r for r in all_of(svg, "rect") if r.get("stroke")]
    assert sum(float(r.get("height", "0")) for r in boxes) / -scale == pytest.approx(500, rel=2e-3)
    assert "2 without limit" in svg


def test_bars_are_as_long_as_their_values_and_sorted() -> None:
    svg = bars(Bars(["a", "b<", "c"], np.array([1.0, -4.0, 2.0]), "mm per mm"), TITLE)
    wide = [float(r.get("width", "0")) for r in all_of(svg, "rect") if r.get("stroke")]
    np.testing.assert_allclose(np.array(wide) / wide[2], [4, 2, 1], rtol=1e-3)
    names = [t.text for t in all_of(svg, "text") if t.text in ("a", "b<", "c")]
    assert names == ["b<", "c", "a"]
    assert "and 15 smaller ones" in bars(Bars([str(k) for k in range(40)], np.arange(40.0), "x"), TITLE)


@pytest.mark.parametrize("values", [[], [np.inf], [1.0] * 5, [0.0]])
def test_odd_values_are_drawn_too(values: list[float]) -> None:
    ElementTree.fromstring(histogram(Histogram(np.array(values), "x"), TITLE).encode())
    if values:
        found = curve(Curve(np.array(values), np.array(values), XY), TITLE)
        assert "nan" not in found


def test_wrong_shapes_are_refused() -> None:
    with pytest.raises(wr.InputError):
        curve(Curve(np.zeros(3), np.zeros(2), XY), TITLE)
    with pytest.raises(wr.InputError):
        bars(Bars(["a"], np.array([np.nan]), "x"), TITLE)


def test_bars_above_the_limit_are_red_and_no_bar_holds_both() -> None:
    values = np.random.default_rng(3).normal(2.0, 0.1, 400)
    svg = histogram(Histogram(values, "motion mm", [(2.0, "half")], (2.07, "limit")), TITLE)
    up, _ = axis(svg, of_x=False)
    across, zero = axis(svg, of_x=True)
    boxes = [r for r in all_of(svg, "rect") if r.get("stroke")]
    red = [r for r in boxes if r.get("fill") == palette.FIXED[0]]
    assert sum(float(r.get("height", "0")) for r in red) / -up == pytest.approx((values > 2.07).sum(), rel=2e-3)
    assert sum(float(r.get("height", "0")) for r in boxes) / -up == pytest.approx(400, rel=2e-3)
    assert (min(float(r.get("x", "0")) for r in red) - zero) / across == pytest.approx(2.07, abs=2e-3)
    ends = [float(r.get("x", "0")) + float(r.get("width", "0")) for r in boxes]
    grid = next(p.get("d", "") for p in all_of(svg, "path") if p.get("stroke") == palette.GRID)
    assert max(ends) <= float(grid.split("L")[1].split(",")[0])
    assert "limit" in svg
    assert palette.FIXED[0] not in histogram(Histogram(values, "x", limit=(9.0, "far")), TITLE)


@pytest.mark.parametrize(("seed", "framed"), [(0, True), (1, False), (2, True), (3, False)])
def test_no_line_and_no_other_label_crosses_the_label_of_a_line(seed: int, framed: bool) -> None:
    random = np.random.default_rng(seed)
    values = random.gamma(random.uniform(0.5, 8), size=60)
    ends = {f"{100 * q:g} % below": float(np.quantile(values, q)) for q in (0.05, 0.5, 0.95)}
    marks = [(end, f"{words} {end:.4g}") for words, end in ends.items()]
    limit = float(np.quantile(values, random.uniform()))
    figure = Histogram(values, "motion mm", marks, (limit, f"limit {limit:.4g}"))
    svg = histogram(figure, Heading("", framed=framed))
    said = re.findall(r'paint-order[^>]*><text x="([\d.]+)" y="([\d.]+)"[^>]*>([^<]*)<', svg)
    lines = [tuple(map(float, line)) for line in re.findall(r'<path d="M([\d.]+),([\d.]+)v([\d.]+)"', svg)]
    assert len(said) == len(lines) == 4
    width = ElementTree.fromstring(svg).get("width")
    assert width is not None
    for k, (x, y, words) in enumerate(said):
        left, base = float(x), float(y)
        right = left + text_width(words, palette.TEXT_SIZE)
        assert 0 < left < right < float(width)
        assert not [1 for at, top, long in lines if left < at < right and top < base - 4 < top + long]
        assert all(abs(float(other) - base) >= palette.TEXT_SIZE for _, other, _ in said[:k])
    for at, top, _ in lines:  # each begins at a label beside or over it
        near = [
            (x, y) for x, y, words in said if float(x) - 8 < at < float(x) + text_width(words, palette.TEXT_SIZE) + 8
        ]
        assert any(-7 < float(y) - top < 15 for _, y in near)
