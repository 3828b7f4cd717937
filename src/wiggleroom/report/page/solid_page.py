"""An answer in space as one HTML file: parts to turn by hand, their path, what holds them, and how sure it is."""

from __future__ import annotations

import base64
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.drawing.writers.plain_json import json_bytes
from wiggleroom.report.page.standalone_page import hashed, shipped
from wiggleroom.report.pictures.text import escape
from wiggleroom.report.results.answer_words import (
    assembly_lines,
    certainty,
    few,
    headline,
    number,
    short,
    towards,
    verdict_sentence,
)
from wiggleroom.report.results.separability import check_title, last_direction, why
from wiggleroom.report.results.table import fixed
from wiggleroom.report.solids.exploded_view import exploded_offsets
from wiggleroom.report.solids.solid_colours import Colour, part_colours
from wiggleroom.report.solids.spatial_path import timed_path, with_quaternions
from wiggleroom.schema.reply_base import Cell
from wiggleroom.schema.study_replies import Piece
from wiggleroom.search.answer import Answer, Contact

Floats = NDArray[np.float64]

MAX_ROWS = 200
"""Rows of a table."""
STYLE = """
:root { color-scheme: light dark; --ink: #1f2933; --quiet: #5b6774; --paper: #fbfaf7; --line: #d9d5cc; --accent: #a85800; }
@media (prefers-color-scheme: dark) { :root { --ink: #e8edf2; --quiet: #a3aeba; --paper: #161b21; --line: #39424d; --accent: #ffb04d; } }
* { box-sizing: border-box; }
body { margin: 0; font: 15px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); display: grid;
  grid-template-columns: minmax(0, 1fr) minmax(300px, 26rem); height: 100vh; }
main { display: flex; flex-direction: column; min-width: 0; min-height: 0; }
#view { flex: 1; min-height: 240px; position: relative; overflow: hidden; }
#view canvas { position: absolute; inset: 0; width: 100% !important; height: 100% !important; display: block; }
.bar { display: flex; gap: 1rem; align-items: center; padding: .6rem 1rem; border-top: 1px solid var(--line); flex-wrap: wrap; }
.bar label { display: flex; gap: .5rem; align-items: center; flex: 1 1 12rem; }
.bar input { flex: 1; accent-color: var(--accent); min-width: 5rem; }
button { font: inherit; color: inherit; background: none; border: 1px solid var(--quiet); border-radius: 6px;
  padding: .25rem .9rem; cursor: pointer; }
aside { overflow: auto; padding: 1rem 1.2rem; border-left: 1px solid var(--line); }
h1 { font-size: 1.25rem; line-height: 1.3; margin: 0 0 .4rem; overflow-wrap: anywhere; }
h2 { font-size: 1rem; margin: 1.2rem 0 .3rem; }
p { margin: .2rem 0; } .quiet { color: var(--quiet); } .verdict { font-weight: 600; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; font-size: 13px; }
th, td { text-align: right; padding: .15rem .3rem; border-bottom: 1px solid var(--line); }
th:first-child, td:first-child { text-align: left; }
td:first-child { overflow-wrap: anywhere; } td label { display: flex; gap: .4rem; align-items: center; }
aside svg { max-width: 100%; height: auto; }
code { font-size: 12px; overflow-wrap: anywhere; }
@media (max-width: 800px) { body { grid-template-columns: 1fr; height: auto; } main { height: 75vh; }
  aside { border-left: 0; border-top: 1px solid var(--line); } }
@media print { :root { color-scheme: light; --ink: #1f2933; --quiet: #5b6774; --paper: white; --line: #d9d5cc; }
  body { display: block; height: auto; } main { height: 120mm; } .bar, td input { display: none; }
  aside { overflow: visible; border: 0; padding: 0; } tr { break-inside: avoid; } }
"""


def page_of_spatial_answer(answer: Answer, command: str = "") -> str:
    """Answer as a page: orbit, the path from rest by a slider, contacts at its end."""
    sure = [
        f'<p><span class="verdict">{escape(answer.verdict.value)}</span>: {escape(verdict_sentence(answer))}</p>',
        f"<p>gap {number(answer.assembly.gap)} mm; {escape(certainty(answer))}; "
        f"deepest overlap {number(answer.deepest_overlap, 2)} mm</p>",
    ]
    if answer.leaves:
        sure.append(f"<p>leaves: {escape(few(answer.leaves))}</p>")
    if answer.turns:
        sure.append(f"<p>turns without limit: {escape(few(answer.turns))}</p>")
    rows = _motion_rows(answer.assembly, answer.motion)
    held = [
        [" | ".join(short(n) for n in c.parts), *(fixed(x, answer.assembly.size) for x in c.point), number(c.force, 3)]
        for c in answer.contacts[:MAX_ROWS]
    ]
    body = "".join(sure) + _table("Motion", ("part", "dx mm", "dy mm", "dz mm", "turn °"), rows, ticks=True)
    if held:
        body += _table("Held by", ("contact", "x mm", "y mm", "z mm", "force"), held)
    foot = f"{answer.solver} on {answer.model}, {answer.iterations} iterations"
    return _page(headline(answer), body, foot, command, _scene(answer.assembly, answer.waypoints, answer.contacts))


def page_of_separation(found: Interlock, command: str = "") -> str:
    """How it comes apart as a page: which parts leave, in which order, along which path."""
    body = f'<p><span class="verdict">{escape(found.verdict.value)}</span>: {escape(why(found))}</p>'
    body += f"<p>gap {number(found.assembly.gap)} mm</p>"
    rows = [[f"{k + 1}. {few(e.parts)}", towards(last_direction(found, e))] for k, e in enumerate(found.escapes)]
    if rows:
        body += _table("Leaves", ("parts", "last in"), rows)
    waypoints = (
        np.concatenate([e.path for e in found.escapes])
        if found.escapes
        else np.zeros((1, len(found.assembly.parts), 6))
    )
    body += _table("Parts", ("part",), [[n] for n in found.assembly.names[:MAX_ROWS]], ticks=True)
    return _page(
        check_title(found),
        body,
        f"{found.questions} questions",
        command,
        _scene(found.assembly, waypoints, ()),
        at_end=False,
    )


def page_of_spatial_study(
    title: str,
    facts: Sequence[str],
    sections: Sequence[Piece],
    about: Answer | Assembly,
    command: str = "",
    colours: Sequence[Colour] | None = None,
    *,
    at_end: bool = True,
) -> str:
    """Study as a page: the motion it is about, or the parts at rest, beside its figures and tables."""
    body = "".join(f"<p>{escape(line)}</p>" for line in facts)
    for piece in sections:
        body += f"<h2>{escape(piece.title)}</h2>" + (f"<p>{escape(piece.text)}</p>" if piece.text else "") + piece.svg
        if piece.rows:
            cells = [[_said(cell) for cell in row] for row in piece.rows[:MAX_ROWS]]
            body += _table("", piece.columns, cells)
        body += "".join(f"<p>{escape(term)}: {escape(sentence)}</p>" for term, sentence in piece.terms)
    if isinstance(about, Answer):
        return _page(
            title, body, "", command, _scene(about.assembly, about.waypoints, about.contacts, colours), at_end=at_end
        )
    still = np.zeros((1, len(about.parts), 6))
    return _page(title, body, "", command, _scene(about, still, (), colours))


def _said(cell: Cell) -> str:
    """A cell of a table as text."""
    if isinstance(cell, str):
        return cell
    if isinstance(cell, list):
        return " | ".join(cell)
    return "" if cell is None or not math.isfinite(cell) else number(cell)


def page_of_spatial_assembly(assembly: Assembly) -> str:
    """Assembly in space as a page: the parts at rest, to be turned and taken apart, and what the file asks."""
    title, *more = assembly_lines(assembly)
    still = np.zeros((1, len(assembly.parts), 6))
    rows = [[part.name, "stands" if part.fixed else ""] for part in assembly.parts[:MAX_ROWS]]
    body = "".join(f"<p>{escape(line)}</p>" for line in more) + _table("Parts", ("part", ""), rows, ticks=True)
    return _page(title, body, "", "", _scene(assembly, still, ()))


def _motion_rows(assembly: Assembly, motion: Floats) -> list[list[str]]:
    farthest = float(np.linalg.norm(motion[:, :3], axis=1).max(initial=0.0))
    return [
        [name, *(fixed(x, farthest) for x in m[:3].tolist()), f"{math.degrees(float(np.linalg.norm(m[3:]))):.3f}"]
        for name, m in list(zip(assembly.names, motion, strict=True))[:MAX_ROWS]
    ]


def _table(title: str, heads: Sequence[str], rows: Sequence[Sequence[str]], ticks: bool = False) -> str:
    """Table under its heading; with `ticks` every first cell shows or hides a part."""
    out = [
        f"<h2>{escape(title)}</h2>" if title else "",
        "<table><tr>",
        *(f"<th>{escape(h)}</th>" for h in heads),
        "</tr>",
    ]
    for k, row in enumerate(rows):
        first = escape(short(row[0]))
        if ticks:
            first = f'<label><input type="checkbox" checked data-part="{k}">{first}</label>'
        out.append(f"<tr><td>{first}</td>" + "".join(f"<td>{escape(cell)}</td>" for cell in row[1:]) + "</tr>")
    return "".join([*out, "</table>"])


def _page(
    title: str,
    body: str,
    foot: str,
    command: str,
    scene: dict[str, object],
    *,
    at_end: bool = True,
) -> str:
    """The page, with what its view shows; it opens at the end of the path, or at rest."""
    data = json_bytes(scene).decode().replace("<", "\\u003c")
    script = shipped("space-view.js")
    policy = f"default-src 'none'; img-src data:; style-src {hashed(STYLE)}; script-src {hashed(script)}"
    asked = f"<h2>Command</h2><p><code>{escape(command)}</code></p>" if command else ""
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}"><link rel="icon" href="data:,">'
        f"<title>{escape(title)}</title><style>{STYLE}</style></head>\n<body><main>"
        '<div id="view"><noscript>This page needs JavaScript.</noscript></div>'
        '<div class="bar"><button id="play" type="button">Play</button>'
        '<label>path <input id="path" type="range" min="0" max="1" step="0.001" value="'
        + ("1" if at_end else "0")
        + '"></label>'
        '<label>exploded <input id="explode" type="range" min="0" max="1.5" step="0.01" value="0"></label></div></main>'
        f'<aside><h1>{escape(title)}</h1>{body}{asked}<p class="quiet">{escape(foot)}</p></aside>'
        f'<script type="application/json" id="solid">{data}</script>\n<script type="module">{script}</script></body></html>\n'
    )


def _scene(
    assembly: Assembly,
    waypoints: Floats,
    contacts: Sequence[Contact],
    colours: Sequence[Colour] | None = None,
) -> dict[str, object]:
    """What the view shows, as data."""
    reference = assembly.reference
    parts = []
    corners = []
    shown = colours or part_colours(assembly)
    for part, made, at, colour, aside in zip(
        assembly.parts, assembly.solids, reference, shown, exploded_offsets(assembly).tolist(), strict=True
    ):
        world = made.surface.vertices @ part.R.T + part.at
        corners.append(world)
        parts.append(
            {
                "name": part.name,
                "colour": list(colour),
                "vertices": packed(world - at, "<f4"),
                "triangles": packed(made.surface.faces, "<u4"),
                "reference": at.tolist(),
                "aside": aside,
            }
        )
    everything = np.vstack(corners)
    size = float(np.ptp(everything, axis=0).max())
    times, timed = timed_path(assembly, waypoints)
    strongest = max((c.force for c in contacts), default=1.0)
    return {
        "parts": parts,
        "times": times.tolist(),
        "motions": packed(with_quaternions(timed), "<f4"),
        "contacts": [
            {"point": list(c.point), "normal": list(c.normal), "share": c.force / strongest} for c in contacts
        ],
        "size": size,
    }


def packed(values: NDArray[np.generic], kind: str) -> str:
    """Base64 of numbers as little-endian bytes of a kind such as "<f4"."""
    return base64.b64encode(np.ascontiguousarray(values.astype(kind)).tobytes()).decode()
