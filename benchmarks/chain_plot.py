"""Chains against gap, as a plot: `python -m benchmarks.chain_plot OUT.svg`.

The sweep of ten tees and of ten swallowtails, the true optimum (the dynamic programme of tests/oracle), and the paper's
hull of three slices at the better of its two turning points. After Fig. 9 of "Mind the Gap".
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from tests.oracle.chain import reach, slices

import wiggleroom as wr
from wiggleroom.files import write_whole
from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.axes import Axes, plot, span, svg_document, text

BLOCKS = 10
GAPS = np.linspace(0.005, 0.03, 11)
COLOURS = {"swallowtail": palette.PULLED[1], "tee": palette.CHOSEN}


def swept(joint: str) -> np.ndarray:
    """Motion for every gap by `sweep` (k,) [mm]."""
    steps = wr.sweep(wr.patterns.chain(BLOCKS, joint=joint), GAPS.tolist()).steps
    return np.array([np.nan if s.objective is None else s.objective for s in steps])


def hull(joint: str, gap: float) -> float:
    """Motion by the paper's hull, at the better turning point [mm]."""
    chain = wr.patterns.chain(BLOCKS, joint=joint, gap=gap)
    return max(wr.flex(chain, model=wr.Hull(about)).objective or 0.0 for about in ("reference", "joint"))


def path(axes: Axes, y: np.ndarray, style: str) -> str:
    """Line through the values at all gaps."""
    points = "L".join(f"{u:.2f},{v:.2f}" for u, v in axes.pixels(GAPS, y).tolist())
    return f'<path d="M{points}" fill="none" stroke-linejoin="round" {style}/>'


def drawn(command: str) -> str:
    """The plot as SVG."""
    truth = {joint: np.array([reach(slices(joint, g), BLOCKS).value for g in GAPS]) for joint in COLOURS}
    found = {joint: swept(joint) for joint in COLOURS}
    theirs = {joint: np.array([hull(joint, g) for g in GAPS]) for joint in COLOURS}
    short = max(float(np.abs(found[j] / truth[j] - 1).max()) for j in COLOURS)
    share = {
        j: f"{100 * (theirs[j] / truth[j]).min():.0f} to {100 * (theirs[j] / truth[j]).max():.0f} %" for j in COLOURS
    }
    title = "Ten blocks in a row: how far the last one moves sideways"
    facts = [f"sweep meets the true optimum within {short:.0e}"]
    facts += [f"hull of three slices, {joint}: {share[joint]} of it" for joint in COLOURS]
    labels = ("gap mm, blocks of 1 mm", "motion mm")
    axes, body = plot((0.0, 0.036), span(truth["swallowtail"], zero=True), labels, title, facts)
    for joint, colour in COLOURS.items():
        body.append(path(axes, truth[joint], f'stroke="{colour}" stroke-width="2"'))
        body.append(path(axes, theirs[joint], f'stroke="{colour}" stroke-width="1.5" stroke-dasharray="2 5"'))
        body += [
            f'<circle cx="{u:.2f}" cy="{v:.2f}" r="5" fill="{palette.PAPER}" stroke="{colour}" stroke-width="2"/>'
            for u, v in axes.pixels(GAPS, found[joint]).tolist()
        ]
        ends = axes.pixels(GAPS[[-1, -1]], np.array([truth[joint][-1], theirs[joint][-1]])).tolist()
        body.append(text(ends[0][0] + 12, ends[0][1] + 5, palette.TEXT_SIZE, colour, joint))
    # the hulls of both joints end almost at one height: one name for both
    body.append(text(ends[1][0] + 12, ends[1][1] + 5, palette.TEXT_SIZE, palette.SUBDUED, "hull, both"))
    at, y = axes.left + 24, axes.top + 22
    for k, (mark, said) in enumerate(
        (
            (
                f'<circle cx="14" cy="0" r="5" fill="{palette.PAPER}" stroke="{palette.INK}" stroke-width="2"/>',
                "wiggleroom sweep",
            ),
            (f'<path d="M0,0h28" stroke="{palette.INK}" stroke-width="2"/>', "true optimum: exact dynamic programme"),
            (
                f'<path d="M0,0h28" stroke="{palette.INK}" stroke-width="1.5" stroke-dasharray="2 5"/>',
                "the paper's hull of three slices, as written here",
            ),
        )
    ):
        body.append(f'<g transform="translate({at:.2f} {y + 24 * k:.2f})">{mark}</g>')
        label = text(at + 40, y + 24 * k + 5, palette.TEXT_SIZE, palette.INK, said)
        body.append(f'<g paint-order="stroke" stroke="{palette.PAPER}" stroke-width="5">{label}</g>')
    return svg_document(axes, body, title, facts, command)


def main() -> None:
    """Write the plot."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    out = parser.parse_args().out
    write_whole(out, drawn(f"python -m benchmarks.chain_plot {out}"))


if __name__ == "__main__":
    main()
