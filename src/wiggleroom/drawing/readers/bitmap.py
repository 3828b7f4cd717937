"""A bitmap as a grid of dark and light cells."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import InputError, require_extra

if TYPE_CHECKING:
    from PIL.Image import Image as Picture

DEFAULT_COLUMNS = 60
"""Cells in the width of a picture that has more pixels, unless told otherwise."""
MAX_CELLS = 1_000_000
"""Grids with more cells are refused."""


def read_bitmap(path: str | Path, across: int | None = None, threshold: float = 0.5) -> NDArray[np.bool_]:
    """Which cells of a picture are dark (rows, columns), the first row on top.

    Every cell is a square, or as near to it as whole rows allow; its brightness is the mean over its area. What is
    transparent is light.

    Parameters
    ----------
    path : str or Path
        A picture in any format that Pillow reads; of several frames the first counts.
    across : int, optional
        Cells in the width of the picture; by default one a pixel, but at most `DEFAULT_COLUMNS`.
    threshold : float
        Cells darker than this are dark: between 0 (black) and 1 (white).

    Raises
    ------
    InputError
        If the file is no picture, or the numbers make no sense.
    MissingExtraError
        Without Pillow (extra `image`).
    """
    image = _library()
    name = Path(path).name
    if not 0 < threshold < 1:
        message = f"threshold is {threshold:g}: it must lie between 0 (black) and 1 (white)"
        raise InputError(message)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", image.DecompressionBombWarning)
            with image.open(path) as opened:
                grey = _grey(opened)
    except FileNotFoundError:
        message = f"{name}: there is no such file"
        raise InputError(message) from None
    except (image.DecompressionBombError, image.DecompressionBombWarning):
        message = f"{name}: this picture has too many pixels; make it smaller"
        raise InputError(message) from None
    except (image.UnidentifiedImageError, OSError, SyntaxError, ValueError) as problem:
        reason = getattr(problem, "strerror", None) or " ".join(str(problem).split()) or "damaged"
        message = f"{name}: this is no picture that can be read ({reason.lower()})"
        raise InputError(message) from None
    height, width = grey.shape
    columns = min(width, DEFAULT_COLUMNS) if across is None else across
    rows = max(1, round(height * columns / width))
    if not (columns >= 1 and columns * rows <= MAX_CELLS):
        most = math.isqrt(int(MAX_CELLS * width / height))
        message = f"{name}: {columns} blocks across: it must be between 1 and {most}"
        raise InputError(message)
    cells = image.fromarray(grey).resize((columns, rows), image.Resampling.BOX)
    return np.asarray(cells) < threshold


def _grey(picture: Picture) -> NDArray[np.float32]:
    """Brightness of every pixel, 0 to 1, on a white ground."""
    from PIL import ImageOps

    if picture.mode[0] in "IF":  # 16 bits a pixel, or numbers of any size
        values = np.asarray(picture, dtype=np.float32)
        return values / max(65535.0 if picture.mode[0] == "I" else 1.0, float(values.max()))
    upright = ImageOps.exif_transpose(picture).convert("RGBA")
    red, green, blue, alpha = np.moveaxis(np.asarray(upright, dtype=np.float32) / 255, -1, 0)
    return 1 - alpha * (1 - (0.299 * red + 0.587 * green + 0.114 * blue))


def _library() -> Any:
    """Pillow, imported when it is needed."""
    require_extra("image", "pictures need Pillow", "PIL")
    from PIL import Image

    return Image
