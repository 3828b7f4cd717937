"""An assembly made ready for the model of walls: where outlines have very many corners, the search is given fewer, a little further out.

The audit of its path gets those that were drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, rings_at
from wiggleroom.errors import InputError, Stop, TouchingError
from wiggleroom.geometry.outer_simplification import MIN_CORNERS, is_fine, simplified_outward
from wiggleroom.search.answer import Answer, Contact
from wiggleroom.search.prepare import Prepared, Survey, prepare_as_drawn, survey, typical_clearance

Floats = NDArray[np.float64]

TOLERANCES = (0.02, 0.05, 0.1, 0.2)
"""How far outlines may be moved out, as a share of the clearance: more where cells would need too many walls."""
FINE_TOLERANCE = 4e-4
"""The same near the contacts that an answer has."""
NOWHERE = np.zeros((0, 3))
"""No places."""


def prepare_simplified(
    assembly: Assembly, near: Floats = NOWHERE, stop: Stop | None = None, clearance: float | None = None
) -> Prepared | None:
    """The assembly made ready with fewer corners; None where its outlines have no more than they need.

    Parameters
    ----------
    assembly : Assembly
    near : (k, 3) float64
        Part and (x, y) [mm] of places, in the part's frame, where outlines hardly move.
    stop : optional
    clearance : float, optional [mm]
        The typical one, where it is known already.
    """
    if not any(len(ring) >= MIN_CORNERS for part in assembly.parts for ring in rings_at(part)):
        return None
    if clearance is None:
        boundaries = np.array(
            [shapely.MultiLineString([shapely.LinearRing(r) for r in rings_at(p)]) for p in assembly.parts]
        )
        clearance = typical_clearance(assembly.gap, boundaries, assembly.size, stop)
    if not is_fine(assembly, clearance):
        return None
    for tolerance in TOLERANCES:
        cover = simplified_outward(assembly, clearance, tolerance * clearance, near, FINE_TOLERANCE * clearance, stop)
        try:
            ready = prepare_as_drawn(cover, surveyed=survey(cover, stop, clearance), stop=stop)
        except TouchingError:  # what was drawn may touch, or not
            return None
        except InputError:
            continue
        return replace(ready, assembly=assembly, simplified=tolerance * clearance)
    return None


def prepare_walls(assembly: Assembly, surveyed: Survey | None = None, stop: Stop | None = None) -> Prepared:
    """The assembly made ready: with fewer corners where outlines have too many, else as drawn; raises as `prepare_as_drawn` does."""
    return prepare_simplified(assembly, stop=stop) or prepare_as_drawn(assembly, surveyed=surveyed, stop=stop)


def refined_at_contacts(ready: Prepared, *answers: Answer) -> Prepared:
    """The same, simplified outlines as near to what was drawn as they were in the end where answers have contacts."""
    places = np.concatenate([contact_places(answer) for answer in answers]) if ready.simplified else NOWHERE
    return (prepare_simplified(ready.assembly, places, clearance=ready.clearance) or ready) if len(places) else ready


def contact_places(answer: Answer) -> Floats:
    """Part and place in its frame (k, 3) of the contacts of an answer, for both parts of each."""
    names = answer.assembly.names
    pose = answer.assembly.rest + answer.motion
    rows = [_place(names.index(name), pose, contact) for contact in _held(answer.contacts) for name in contact.parts]
    return np.array(rows).reshape(-1, 3)


def held_back(answer: Answer) -> float:
    """What a motion would gain, to first order, if its contacts were as deep as outlines were drawn: in the unit of its objective.

    It is the sum of forces times the distances by which the outlines that were searched lie further out there.
    """
    places = contact_places(answer)
    force = np.repeat([contact.force for contact in _held(answer.contacts)], 2)
    away = np.zeros(len(places))
    for k in np.unique(places[:, 0]).astype(int):
        mine = places[:, 0] == k
        rings = [ring for region in answer.assembly.parts[k].regions for ring in (region.outer, *region.holes)]
        drawn = shapely.multilinestrings([shapely.linearrings(ring) for ring in rings])
        away[mine] = shapely.distance(shapely.points(places[mine, 1:]), drawn)
    return float(force @ away)


def _held(contacts: Sequence[Contact]) -> list[Contact]:
    return [contact for contact in contacts if contact.force > 0]


def _place(part: int, pose: Floats, contact: Contact) -> tuple[float, float, float]:
    x, y = np.subtract(contact.point, pose[part, :2])
    c, s = np.cos(pose[part, 2]), np.sin(pose[part, 2])
    return part, c * x + s * y, c * y - s * x
