"""Directional blocking graphs: which sets of parts drawn tight can begin to slide in some direction, without turning.

In the graph of a direction d an arc leads from i to j where i cannot begin to move along d before j does: some contact's normal from i
into j has a positive share of d. A set of bodies from which no arc leads out can move. Which contacts block changes only at the
directions along which some contact slides, and at such a direction blocks less than on either side of it, so these finitely many
directions decide (the non-directional blocking graph); d and -d have the same graph with its arcs turned round, so a half circle does.

Sources: Wilson and Latombe 1994; the test for interlocking with a key: Wang, Song and Pauly 2018 (DESIA). It sees sets that
move as one in a single direction: two parts that must move in different directions at once, and turns, are beyond it; see
`wiggleroom.form_closure.mobility`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import csgraph

from wiggleroom.assembly.assembly import Assembly, require_planar
from wiggleroom.displayable import Displayable
from wiggleroom.form_closure.point_contacts import ANGLE_TOLERANCE, PointContacts, point_contacts

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

Move = tuple[tuple[str, ...], tuple[float, float]]
"""Parts, and the direction in which they can begin to slide together."""


@dataclass(frozen=True, eq=False)
class Blocking(Displayable):
    """Result of the directional blocking graphs of parts drawn tight.

    Parameters
    ----------
    verdict : str
        "locked": no set of parts can begin to slide. "keyed": only one part can, the key; while it stays nothing else can. "moves": other
        sets can begin to slide.
    key : str
        Name of the key part (of the first of its glued parts), or empty.
    moves : tuple of (names, direction)
        Every smallest set without the standing body that can begin to slide, with one direction in which it can.
    directions : (m, 2) float64
        Deciding unit directions, within half a circle.
    components : (m, bodies) int64
        Strongly connected component of every body in the graph of each direction.
    contacts : PointContacts
    """

    verdict: str
    key: str
    moves: tuple[Move, ...]
    directions: Floats
    components: Ints
    contacts: PointContacts


def blocking(assembly: Assembly, within: float | None = None) -> Blocking:
    """Sets of parts, as drawn tight, that can begin to slide.

    Parameters
    ----------
    assembly : Assembly
    within : float, optional [mm]
        Outlines closer than this touch; by default a millionth of the drawing's size.

    Raises
    ------
    InputError
        If `within` is no length.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> blocking(wr.patterns.chain(3, "tee")).verdict
    'locked'
    >>> blocking(wr.patterns.chain(2, "finger")).moves
    ((('b2',), (1.0, 0.0)),)
    """
    require_planar(assembly, "blocking")
    contacts = point_contacts(assembly, within)
    directions = _deciding(contacts)
    graphs = [blocking_graph(contacts, d) for d in directions]
    components = np.array([csgraph.connected_components(g, connection="strong")[1] for g in graphs], dtype=np.int64)
    components = components.reshape(len(directions), contacts.count)
    sets = _movable(contacts, directions, graphs, components)
    members = contacts.members
    moves = tuple((tuple(name for body in bodies for name in members[body]), direction) for bodies, direction in sets)
    key = _key(components, contacts.ground)
    verdict = "locked" if not sets else "keyed" if key >= 0 else "moves"
    return Blocking(verdict, members[key][0] if key >= 0 else "", moves, directions, components, contacts)


def blocking_graph(contacts: PointContacts, direction: Floats) -> sparse.csr_array:
    """Arcs (n, n) from each body to those it would run into if it began to move along `direction` (2,)."""
    share = contacts.normal @ np.asarray(direction, dtype=float)
    ahead, behind = share > ANGLE_TOLERANCE, share < -ANGLE_TOLERANCE
    i = np.r_[contacts.a[ahead], contacts.b[behind]]
    j = np.r_[contacts.b[ahead], contacts.a[behind]]
    return sparse.csr_array((np.ones(len(i), dtype=np.int8), (i, j)), shape=(contacts.count,) * 2)


def _deciding(contacts: PointContacts) -> Floats:
    """Directions in which some contact slides, each once, within half a circle."""
    nx, ny = contacts.normal.T
    angle = np.sort(np.arctan2(nx, -ny) % np.pi)
    if not len(angle):
        return np.array([[1.0, 0.0]])
    angle = angle[np.diff(angle, prepend=angle[0] - 1) > ANGLE_TOLERANCE]
    if len(angle) > 1 and angle[-1] > angle[0] + np.pi - ANGLE_TOLERANCE:
        angle = angle[:-1]
    direction = np.column_stack([np.cos(angle), np.sin(angle)])
    return np.where(np.abs(direction) < 1e-12, 0.0, direction)


def _movable(
    contacts: PointContacts, directions: Floats, graphs: list[sparse.csr_array], components: Ints
) -> list[tuple[tuple[int, ...], tuple[float, float]]]:
    """Smallest sets from which no arc leads out, along each direction and against it; the standing body stands."""
    found: dict[tuple[int, ...], tuple[float, float]] = {}
    for direction, graph, label in zip(directions, graphs, components, strict=True):
        i, j = graph.nonzero()
        for sign, tail, head in ((1.0, i, j), (-1.0, j, i)):
            for k in unblocked(tail, head, label, contacts.ground):
                found.setdefault(tuple(np.flatnonzero(label == k).tolist()), _pair(sign * direction))
    return list(found.items())


def _pair(direction: Floats) -> tuple[float, float]:
    return float(direction[0]) + 0.0, float(direction[1]) + 0.0


def _key(components: Ints, ground: int) -> int:
    """The body that is alone against all others in every graph that falls apart, or -1; the standing body only where no other is."""
    keys = np.arange(components.shape[1])
    for label in components:
        sizes = np.bincount(label)
        if len(sizes) > 2:
            return -1
        if len(sizes) == 2:
            keys = keys[sizes[label[keys]] == 1]
    if len(keys) == components.shape[1]:
        return -1
    return next((int(k) for k in keys if k != ground), int(keys[0]) if len(keys) else -1)


def unblocked(tail: Ints, head: Ints, label: Ints, ground: int) -> Ints:
    """Strongly connected components that can move alone: no arc leads out of them, and the ground is not among them.

    Parameters
    ----------
    tail, head : (m,) int64
        Arcs of the graph, from and to nodes.
    label : (n,) int64
        Component of every node.
    ground : int
        The node of the fixed bodies.

    Examples
    --------
    >>> unblocked(np.array([1, 2]), np.array([0, 1]), np.array([0, 1, 2]), ground=2)  # 2 stops at 1, 1 at 0
    array([0])
    """
    between = label[tail] != label[head]
    return np.setdiff1d(label, np.append(label[tail[between]], label[ground]))
