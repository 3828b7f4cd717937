"""JSON of values that may be numpy's."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np


def json_bytes(value: Any) -> bytes:
    """JSON as bytes; numbers that JSON cannot say become null.

    Raises
    ------
    TypeError
        If there is something in it that is neither plain nor numpy's.

    Examples
    --------
    >>> json_bytes({"x": np.float64(0.5), "y": np.array([1, 2]), "z": float("nan")})
    b'{"x":0.5,"y":[1,2],"z":null}'
    """
    return msgspec.json.encode(value, enc_hook=plain)


def plain(value: Any) -> Any:
    """What `value`, numpy's, is in plain Python."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    message = f"{type(value).__name__} {value!r} cannot be said in JSON"
    raise TypeError(message)
