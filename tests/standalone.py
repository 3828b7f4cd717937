"""What a standalone page carries, read back."""

from __future__ import annotations

import base64
import json
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray


def told(html: str) -> dict[str, Any]:
    """What a standalone page carries."""
    found = re.search(r'<script type="application/json" id="standalone">(.*?)</script>', html, re.DOTALL)
    assert found
    return dict(json.loads(found[1]))


def frames(packed: dict[str, Any]) -> NDArray[np.float32]:
    """Motions (k, n, 3) of a path."""
    return np.frombuffer(base64.b64decode(packed["data"]), "<f4").reshape(packed["k"], packed["n"], 3)


def rows(told: dict[str, Any], title: str) -> list[list[Any]]:
    """Rows of the table of a study under a heading."""
    (found,) = [one["rows"] for one in told["study"]["sections"] if one["title"] == title]
    return list(found)
