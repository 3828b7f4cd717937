"""The live page as one file: what was found is in it, and the same bundle that `serve` shows; it needs no server."""

from __future__ import annotations

import base64
import hashlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import resources
from pathlib import PurePath
from typing import Any

import numpy as np
from msgspec import UNSET
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Goal
from wiggleroom.drawing.writers.plain_json import json_bytes
from wiggleroom.report.page.page_messages import answer_message, digits_of, drawing_message
from wiggleroom.report.page.path_frames import path_frames
from wiggleroom.report.pictures.text import escape
from wiggleroom.schema.standalone_schema import (
    PackedFrames,
    PlacedPart,
    SharedOutlines,
    StandaloneAnswer,
    StandaloneDrawing,
    StandalonePage,
)
from wiggleroom.schema.study_replies import Piece
from wiggleroom.search.answer import Answer


def standalone_page(title: str, **found: Any) -> str:
    """One HTML page that carries what was found; what users name is only ever data.

    Parameters
    ----------
    title : str
        Name of the page.
    found
        Fields of `StandalonePage`.
    """
    data = json_bytes(StandalonePage(**found)).decode().replace("<", "\\u003c")
    scripts = [shipped("page.js")]
    if "space" in found:
        scripts.insert(0, shipped("space-view.js"))
    style = shipped("page.css")
    policy = (
        f"default-src 'none'; img-src data:; style-src {hashed(style)}; script-src {' '.join(map(hashed, scripts))}"
    )
    code = "\n".join(f'<script type="module">{script}</script>' for script in scripts)
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1, viewport-fit=cover">'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}"><meta name="color-scheme" content="light dark">'
        f'<link rel="icon" href="data:,"><title>{escape(title)}</title><style>{style}</style></head>\n'
        '<body><div id="page"><noscript>This page needs JavaScript.</noscript></div>'
        f'<script type="application/json" id="standalone">{data}</script>\n{code}</body></html>\n'
    )


def shown_drawing(assembly: Assembly, goals: tuple[Goal, ...] = ()) -> StandaloneDrawing:
    """The drawing as it is shown at rest, and what is asked of it."""
    drawing = replace(assembly.drawing, goals=goals)
    told = drawing_message(drawing, assembly.parts, PurePath(drawing.source).name)
    return StandaloneDrawing(
        name=told.name,
        gap=told.gap,
        unit=told.unit,
        notes=[],
        size=told.size,
        parts=[PlacedPart(part.name, part.at) for part in told.parts],
        design=told.design,
        outlines=shared_outlines(assembly),
    )


def shared_outlines(assembly: Assembly) -> SharedOutlines:
    """Outlines of parts about their reference points [mm]: each `shape` once, and which one a part has."""
    digits = digits_of(assembly.size)
    found: dict[tuple[bytes, ...], int] = {}
    shapes: list[list[list[list[float]]]] = []
    of = []
    for part in assembly.parts:
        rings = [ring.round(digits) for region in part.regions for ring in (region.outer, *region.holes)]
        key = tuple(ring.tobytes() for ring in rings)
        if key not in found:
            found[key] = len(shapes)
            shapes.append([ring.tolist() for ring in rings])
        of.append(found[key])
    return SharedOutlines(shapes, of)  # type: ignore[arg-type]


def shown_answer(answers: Mapping[float, Answer], command: str) -> list[StandaloneAnswer]:
    """Answers by gap [mm], each with the frames of its path, and with its outlines where they are not those of the first."""
    found: list[StandaloneAnswer] = []
    first = None
    for gap, answer in answers.items():
        made = shared_outlines(answer.assembly)
        first = first or made
        frames = packed_frames(answer.assembly, answer.waypoints)
        found.append(StandaloneAnswer(gap, answer_message(answer, command), frames, UNSET if made == first else made))
    return found


def packed_frames(assembly: Assembly, points: NDArray[np.float64]) -> PackedFrames:
    """Frames along a path, as they go over the wire."""
    frames = path_frames(assembly, points).astype("<f4")
    k, n, _ = frames.shape
    return PackedFrames(k, n, base64.b64encode(frames.tobytes()).decode())


def section(
    title: str,
    text: str = "",
    *,
    svg: str = "",
    columns: Sequence[str] = (),
    rows: Sequence[Sequence[str | float | None]] = (),
    terms: Sequence[tuple[str, str]] = (),
) -> Piece:
    """A piece of a page under its heading; infinity is written as a word, because JSON cannot say it."""
    cells = [["∞" if cell == math.inf else cell for cell in row] for row in rows]
    picture = svg[svg.index("<svg") :] if svg else ""
    return Piece(title, text, list(columns), cells, list(terms), picture)  # type: ignore[arg-type]


def hashed(text: str) -> str:
    """What allows exactly this script or style."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def shipped(name: str) -> str:
    """A bundle of the page's, as it may stand inside a page."""
    text = (resources.files("wiggleroom.report") / "web" / name).read_text(encoding="utf-8")
    return text.replace("</script", "<\\/script")
