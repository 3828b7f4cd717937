"""Answer as numpy arrays in one file: for assemblies so large that text takes long to write and to read."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.search.answer import Answer


def answer_arrays(answer: Answer) -> dict[str, NDArray[Any]]:
    """What an answer found, n parts, k waypoints, c contacts.

    Returns
    -------
    dict
        `names` (n,); `motion` (n, 3) and `waypoints` (k, n, 3) [mm, mm, rad], about the reference points; `contact_parts` (c, 2) rows
        of `names`, `contact_point` (c, 2) [mm], `contact_normal` (c, 2), `contact_force` (c,); `objective`, nan where nothing
        stops the motion, `verdict` and `path`.

    Examples
    --------
    >>> import wiggleroom as wr
    >>> arrays = answer_arrays(wr.flex(wr.patterns.chain(3, gap=0.02)))
    >>> arrays["motion"].shape, str(arrays["verdict"])
    ((3, 3), 'proven')
    """
    names = answer.assembly.names
    place = {name: k for k, name in enumerate(names)}
    held = answer.contacts
    return {
        "names": np.array(names),
        "motion": np.asarray(answer.motion),
        "waypoints": np.asarray(answer.waypoints),
        "contact_parts": np.array([[place[name] for name in one.parts] for one in held], dtype=np.int64).reshape(-1, 2),
        "contact_point": np.array([one.point for one in held], dtype=float).reshape(-1, 2),
        "contact_normal": np.array([one.normal for one in held], dtype=float).reshape(-1, 2),
        "contact_force": np.array([one.force for one in held], dtype=float),
        "objective": np.array(np.nan if answer.objective is None else answer.objective),
        "verdict": np.array(str(answer.verdict)),
        "path": np.array(answer.path),
    }


def npz(answer: Answer) -> bytes:
    """The same as the bytes of a file that `numpy.load` reads."""
    out = io.BytesIO()
    np.savez(out, **answer_arrays(answer))  # type: ignore[arg-type]
    return out.getvalue()
