"""Missing glyphs: letters that no font on this machine has, so that a PNG cannot show them."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable

from wiggleroom.report.pictures.png import png
from wiggleroom.report.pictures.text import escape

UNASSIGNED = "\u0378"
"""No font has this one: what stands for it stands for every letter that is missing."""
MAX_LETTERS = 200
"""At most this many different letters are looked for."""


def missing_glyphs(texts: Iterable[str], *, own_font_only: bool = False) -> str:
    """Letters of some texts that neither the package's font nor one of the system has, in order of code.

    Each is set as the pictures set it, and compared with what is set for a letter that does not exist.

    Parameters
    ----------
    own_font_only : bool
        True: that the package's font does not have.

    Examples
    --------
    >>> missing_glyphs(["lid 2", "Größe"])
    ''
    """
    some = sorted({c for text in texts for c in text if not c.isascii() and _is_seen(c)})[:MAX_LETTERS]
    if not some:
        return ""
    blank = {_set(c, own_font_only) for c in (UNASSIGNED, " ")}
    return "".join(c for c in some if _set(c, own_font_only) in blank)


def _is_seen(letter: str) -> bool:
    """True for letters that leave ink: no spaces, combining marks or format characters."""
    return unicodedata.category(letter)[0] in "LNPS"


def _set(letter: str, own_font_only: bool) -> bytes:
    """Picture of one letter."""
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="32" height="32" viewBox="0 0 32 32">'
    return png(
        f'{head}<text x="4" y="24" font-size="20">{escape(letter)}</text></svg>', width=32, own_font_only=own_font_only
    )
