"""One file of a maker, and what the maker expects of it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Case:
    """A file and its maker's expectation, written by hand.

    Parameters
    ----------
    name : str
        With the extension that says how it is read.
    program : str
        What wrote it, or whose style it has.
    data : bytes
    parts : int
    holes : int
        Of all parts together.
    names : tuple of str
        Names that must be among those of the parts.
    noted : tuple of str
        Words that must stand in a note.
    refused : str
        Words of the finding, where the maker expects the file to be refused.
    options : dict
        Read options that the maker gives.
    """

    name: str
    program: str
    data: bytes
    parts: int
    holes: int = 0
    names: tuple[str, ...] = ()
    noted: tuple[str, ...] = ()
    refused: str = ""
    options: tuple[tuple[str, object], ...] = ()
