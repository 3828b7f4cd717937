"""An SVG that plays by itself in browsers (SMIL), without any script."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.report.films.scene import Scene, Track

Floats = NDArray[np.float64]

PAUSES = (0.6, 1.4)
"""Seconds of stillness at rest and at the end of the path, in every kind of film."""


def moving_svg(made: Scene, *, back: bool) -> str:
    """Scene as an SVG that plays for ever.

    Parameters
    ----------
    back : bool
        True: it returns to rest along the same path.
    """
    m = made.frames
    order, times = np.arange(m), np.linspace(0.0, made.seconds, m) + PAUSES[0]
    order, times = np.r_[0, order], np.r_[0.0, times]
    if back:
        order, times = np.r_[order, order[:0:-1]], np.r_[times, times[-1] + PAUSES[1] + times[1:] - times[1]]
        whole = times[-1]
    else:
        order, times = np.r_[order, m - 1], np.r_[times, times[-1] + PAUSES[1]]
        whole = times[-1]
    tracks = "\n".join(_moving(t, order, times / whole, whole) for t in made.tracks)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{made.head}\n<g clip-path="url(#stage)">\n{tracks}\n</g></svg>\n'


def _moving(track: Track, order: NDArray[np.int64], times: Floats, seconds: float) -> str:
    """One track; a still one carries no animation."""
    if track.still:
        return track.drawn(0)
    timing = f'dur="{seconds:.2f}s" repeatCount="indefinite" keyTimes="{_list(times, 4)}"'
    xy, turn = track.place[order, :2], track.place[order, 2]
    values = ";".join(f"{x:.2f} {y:.2f}" for x, y in xy.tolist())
    inner = track.svg
    if np.ptp(turn) > 1e-3:
        spin = f'<animateTransform attributeName="transform" type="rotate" values="{_list(turn, 3)}" {timing}/>'
        inner = f'<g transform="rotate({turn[0]:.3f})">{spin}{inner}</g>'
    elif abs(turn[0]) > 5e-4:
        inner = f'<g transform="rotate({turn[0]:.3f})">{inner}</g>'
    shown = fade = ""
    if np.ptp(track.opacity) > 0:
        shown = f' opacity="{track.opacity[0]:.2f}"'
        fade = f'<animate attributeName="opacity" values="{_list(track.opacity[order], 2)}" {timing}/>'
    at = f"translate({xy[0, 0]:.2f} {xy[0, 1]:.2f})"  # viewers that play nothing show rest
    spread = f'<animateTransform attributeName="transform" type="translate" values="{values}" {timing}/>'
    return f'<g transform="{at}"{shown}>{spread}{fade}{inner}</g>'


def _list(values: Floats, places: int) -> str:
    return ";".join(f"{v:.{places}f}" for v in values.tolist())
