"""Comparisons as pictures; every method keeps its colour and its mark."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from wiggleroom.bench.puzzles import APART
from wiggleroom.bench.result import Bench, Record
from wiggleroom.report.pictures import frame, palette
from wiggleroom.report.pictures.axes import text
from wiggleroom.report.pictures.curve_panels import Curve, Panel, Style, around, legend
from wiggleroom.report.pictures.text import wrap

_TRUTH, _OURS, _HULL, _HULL_2 = "#1f2933", "#1f5f99", "#c96a00", "#e3a008"
_PLANES, _PLANES_2, _OTHER, _THEIRS, _THEIRS_2 = "#00806a", "#74b8a8", "#8c6bb1", "#7a4a1c", "#4d6b62"
STYLES = {
    "true optimum": Style(_TRUTH, "cross"),
    "walls": Style(_OURS, "circle"),
    "hull": Style(_HULL, "square"),
    "hull + our solver": Style(_HULL, "diamond"),
    "hull + IPOPT": Style(_HULL, "square"),
    "hull, joint": Style(_HULL, "square"),
    "hull, reference": Style(_HULL_2, "square"),
    "hull, 8 rounds": Style(_HULL_2, "square"),
    "half-planes": Style(_PLANES, "triangle"),
    "half-planes, at rest": Style(_PLANES_2, "triangle"),
    "physics engine": Style(_OTHER, "diamond", hollow=True),
    "Mind the Gap †": Style(_THEIRS, "square", hollow=True),
    "PuzzleFlex †": Style(_THEIRS_2, "triangle", hollow=True),
}
OTHER = Style(_OTHER, "diamond")
"""Methods without a style of their own."""
LEFT, TOP, HIGH, WIDE, BETWEEN = 70.0, 60.0, 320.0, 440.0, 80.0
ROW_HEIGHT = 34.0
"""[px]"""
LANES = 0.7
"""Share of a row within which each method has its own height, so that no mark hides another."""
LANE_HEIGHT = 58.0
"""Height of such a row [px]."""
NAME_WIDTH = 150.0
"""[px]"""


def comparison_picture(found: Bench, command: str = "") -> str:
    """SVG of a comparison."""
    return PICTURES[found.name](found, command)


def accuracy_picture(found: Bench, command: str) -> str:
    """Rows of dots: how many samples are judged rightly, and how much of the free space is lost."""
    pairs = list(dict.fromkeys(r["pair"] for r in found.records))
    titles = {
        "accuracy_percent": "Judged rightly [% of the samples]",
        "lost_of_free_percent": "Lost [% of the free space]",
    }
    return _two_panels_of_rows(found, command, pairs, titles)


def speed_picture(found: Bench, command: str) -> str:
    """Seconds against parts for grids of tees, and for all joints at the largest size."""
    body, top = frame.header(found.title, _facts(found), 2 * WIDE)
    top += TOP
    timed = [r for r in found.records if "total_seconds" in r]
    names, methods = (list(dict.fromkeys(r[key] for r in timed)) for key in ("assembly", "method"))
    high = max(HIGH, LANE_HEIGHT * len(names))
    curves = [
        _curve(k, some, "parts", "total_seconds") for k, some in _by_method([r for r in timed if r["joint"] == "tee"])
    ]
    left = LEFT
    if curves:
        panel = around(left, top, WIDE, high, curves, (True, True))
        body += panel.axes("Grids of tee blocks", ("parts", "total [s]"))
        for curve in curves[::-1]:
            body += panel.curve(curve)
        left += WIDE + BETWEEN + NAME_WIDTH
    if names:
        seconds = np.array([r["total_seconds"] for r in timed])
        limits = (seconds.min() / 1.6, seconds.max() * 1.6)
        panel = Panel(left, top, WIDE, high, limits, (len(names) - 0.4, -0.6), (True, False))
        body += panel.axes("All assemblies", ("total [s]", ""), names)
        for r in timed:
            lane = (methods.index(r["method"]) + 0.5) / len(methods) - 0.5
            place, row = np.array([r["total_seconds"]]), np.array([names.index(r["assembly"]) + LANES * lane])
            body += panel.curve(Curve("", place, row, STYLES.get(r["method"], OTHER)))
            if r.get("at_least"):
                u, v = panel.pixels(place, row)[0].tolist()
                arrow = f"M{u + 7:.1f},{v:.1f}h10m-4,-3.5l4,3.5l-4,3.5"  # stopped there, so it takes longer
                body.append(f'<path d="{arrow}" fill="none" stroke="{palette.SUBDUED}" stroke-width="1.5"/>')
    return _finished(found, command, body, top + high, left + WIDE, methods)


def chains_picture(found: Bench, command: str) -> str:
    """Displacement against gap, a panel for each joint."""
    body, top = frame.header(found.title, (), 2 * WIDE)
    top += TOP
    joints = list(dict.fromkeys(r["joint"] for r in found.records))
    for k, joint in enumerate(joints):
        mine = [r for r in found.records if r["joint"] == joint and r["moves_mm"] is not None]
        curves = [_curve(name, some, "gap_mm", "moves_mm") for name, some in _by_method(mine)]
        if not curves:
            continue
        panel = around(LEFT + k * (WIDE + BETWEEN), top, WIDE, HIGH, curves)
        body += panel.axes(joint, ("gap [mm]", "moves [mm]"))
        for curve in curves[::-1]:
            body += panel.curve(curve)
    right = LEFT + max(1, len(joints)) * (WIDE + BETWEEN) - BETWEEN
    return _finished(found, command, body, top + HIGH, right, [name for name, _ in _by_method(found.records)])


def interlock_picture(found: Bench, command: str) -> str:
    """Field of answers: a row for each assembly, a column for each method."""
    body, top = frame.header(found.title, (), 2 * WIDE)
    top += 50
    rows = list(dict.fromkeys(r["assembly"] for r in found.records))
    methods = [name for name, _ in _by_method(found.records)]
    wide, high, left = 130.0, 30.0, palette.MARGIN + 270
    truth = {r["assembly"]: r["truth"] for r in found.records}
    body.append(text(left - 12, top - 12, palette.TEXT_SIZE, palette.SUBDUED, "truth", "end"))
    for k, name in enumerate(methods):
        body.append(text(left + (k + 0.5) * wide, top - 12, palette.TEXT_SIZE, palette.INK, name, "middle"))
    for i, row in enumerate(rows):
        y = top + i * high
        body.append(text(palette.MARGIN, y + 20, palette.TEXT_SIZE, palette.INK, row))
        body.append(text(left - 12, y + 20, palette.TEXT_SIZE, palette.SUBDUED, truth[row], "end"))
        for r in (r for r in found.records if r["assembly"] == row):
            x = left + methods.index(r["method"]) * wide
            fill, stroke = palette.PULLED if r["right"] else palette.FIXED
            said = r["says"] if r["says"] in (APART, truth[row], "locked") else r["says"].split(":")[0]
            body.append(
                f'<rect x="{x + 2:.2f}" y="{y + 2:.2f}" width="{wide - 4:.2f}" height="{high - 4:.2f}" rx="3" '
                f'fill="{fill}" stroke="{stroke}"/>'
            )
            shown = said if r["right"] else f"{said} ✗"
            body.append(text(x + wide / 2, y + 20, palette.SMALL_SIZE + 1, palette.INK, shown, "middle"))
    bottom = top + len(rows) * high + 14
    for k, name in enumerate(methods):
        right = sum(r["right"] for r in found.records if r["method"] == name)
        body.append(
            text(
                left + (k + 0.5) * wide, bottom + 8, palette.TEXT_SIZE, palette.INK, f"{right} of {len(rows)}", "middle"
            )
        )
    return _finished(found, command, body, bottom - 20, left + wide * len(methods), [])


PICTURES: dict[str, Callable[[Bench, str], str]] = {
    "accuracy": accuracy_picture,
    "speed": speed_picture,
    "chains": chains_picture,
    "interlock": interlock_picture,
}
"""Registry: what draws each comparison."""


def _two_panels_of_rows(found: Bench, command: str, pairs: Sequence[str], titles: dict[str, str]) -> str:
    body, top = frame.header(found.title, _facts(found), 2 * WIDE)
    top += TOP
    left, high = palette.MARGIN + NAME_WIDTH, ROW_HEIGHT * len(pairs)
    for k, (key, title) in enumerate(titles.items()):
        shown = [r for r in found.records if r.get(key) is not None]
        panel = Panel(left, top, WIDE, high, (-3.0, 103.0), (len(pairs) - 0.5, -0.5))
        rows = pairs if k == 0 else [""] * len(pairs)
        body += panel.axes(title, ("", ""), rows)
        for r in shown[::-1]:
            at = np.array([pairs.index(r["pair"])], dtype=float)
            body += panel.curve(Curve("", np.array([r[key]]), at, STYLES.get(r["method"], OTHER)))
        left += WIDE + BETWEEN / 2
    return _finished(
        found, command, body, top + high, left - BETWEEN / 2, [name for name, _ in _by_method(found.records)]
    )


def _finished(found: Bench, command: str, body: list[str], bottom: float, right: float, methods: Sequence[str]) -> str:
    """Whole SVG: legend, a word on published figures, command."""
    more, y = legend(
        [(name, STYLES.get(name, OTHER)) for name in methods], palette.MARGIN, bottom + 76, right - palette.MARGIN
    )
    body = [*body, *more]
    y += 12
    theirs = [note for note in found.notes if note.startswith("†")]
    for line in (*theirs, *([command] if command else [])):
        for row in wrap(line.split(" "), " ", palette.SMALL_SIZE, right - palette.MARGIN, 3):
            y += palette.SMALL_SIZE + 5
            body.append(text(palette.MARGIN, y, palette.SMALL_SIZE, palette.SUBDUED, row))
    return frame.document(right + palette.MARGIN, y + palette.MARGIN - 12, found.title, found.notes, command, body)


def _curve(name: str, records: Sequence[Record], x: str, y: str) -> Curve:
    values = (np.array([r[key] for r in records], dtype=float) for key in (x, y))
    return Curve(name, next(values), next(values), STYLES.get(name, OTHER))


def _facts(found: Bench) -> Sequence[str]:
    return ("stopped before the last line",) if found.cut else ()


def _by_method(records: Sequence[Record]) -> list[tuple[str, list[Record]]]:
    """Records by method, in the order in which methods first come up."""
    found: dict[str, list[Record]] = {}
    for r in records:
        found.setdefault(r["method"], []).append(r)
    return list(found.items())
