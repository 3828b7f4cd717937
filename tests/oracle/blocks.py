"""Unit-pitch blocks with a tab on the left side and the same shape as a pocket in the right side."""

from __future__ import annotations

import numpy as np
import shapely

from .geometry import inset_polygon


def _round_tab(radius: float = 0.15, neck: float = 0.08, stem: float = 0.05, edges: int = 30) -> np.ndarray:
    """Bulb of `edges` chords on a short straight stem of half-width `neck`."""
    opening = np.arcsin(neck / radius)
    angles = np.linspace(opening, 2 * np.pi - opening, edges + 1)
    circle = radius * np.column_stack([np.cos(angles), np.sin(angles)]) - [radius * np.cos(opening) + stem, 0]
    return np.concatenate([[[0, neck]], circle, [[0, -neck]]])


# Profiles run down the left side: x < 0 sticks out of the block, x = 0 is its side, y is measured from its middle.
PROFILES: dict[str, np.ndarray] = {
    "tee": np.array(
        [
            *([0, 0.075], [-0.08, 0.075], [-0.08, 0.15], [-0.18, 0.15]),
            *([-0.18, -0.15], [-0.08, -0.15], [-0.08, -0.075], [0, -0.075]),
        ]
    ),
    "swallowtail": np.array([[0, 0.1], [-0.25, 0.2], [-0.25, -0.2], [0, -0.1]]),
    "round": _round_tab(),
    "hook": np.array([[0, 0.12], [-0.22, 0.1], [-0.25, -0.17], [-0.09, -0.2], [-0.11, -0.07], [0, -0.05]]),
    "arrow": np.array([[0, 0.06], [-0.12, 0.08], [-0.1, 0.19], [-0.3, 0], [-0.1, -0.19], [-0.12, -0.08], [0, -0.06]]),
}
JOINTS = tuple(PROFILES)


def outline(joint: str) -> np.ndarray:
    """Corners (n, 2) of the block as drawn, counter-clockwise, block centre at the origin, before any gap."""
    return with_profile(PROFILES[joint])


def with_profile(profile: np.ndarray) -> np.ndarray:
    """Unit block with `profile` as tab on its left and as pocket on its right side, counter-clockwise."""
    tab, pocket = np.add(profile, [-0.5, 0]), np.add(profile[::-1], [0.5, 0])
    corners = [[[-0.5, -0.5], [0.5, -0.5]], pocket, [[0.5, 0.5], [-0.5, 0.5]], tab]
    return np.concatenate([np.asarray(c, dtype=float) for c in corners])


def block(joint: str, gap: float) -> shapely.Polygon:
    """Block with every edge moved in by half the gap [same unit as the block]."""
    made = inset_polygon(shapely.Polygon(outline(joint)), gap / 2)
    if made is None:
        raise ValueError(f"{joint}: gap {gap} is too large")
    return made
