"""Write a cut-ready DXF in millimetres."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import StringIO
from typing import Any

from wiggleroom.drawing.model import Drawing
from wiggleroom.drawing.readers.dxf_file import import_ezdxf
from wiggleroom.drawing.readers.dxf_walk import HOLES, NAME
from wiggleroom.drawing.strokes.layers import LABELS
from wiggleroom.drawing.writers.glue_groups import glued_names
from wiggleroom.drawing.writers.lettering import Label, labels_of, lettered
from wiggleroom.drawing.writers.svg_writer import placed_rings

_LAYERS = {"cut": 7, "fixed": 1, HOLES: 3, LABELS: 5}
"""Layers and their colours: black or white, red, green, blue."""
CHUNK_LENGTH = 30
"""Characters of a name in one string of extended data, which holds 255, where one may take 7."""


def write_dxf(drawing: Drawing, labels: Sequence[Label] | None = None) -> str:
    """Text of a DXF (R2000) that reads back as the same drawing; plain ASCII.

    Outer outlines lie on the layer `cut`, or `fixed` where the part stands, inner ones on `holes`; all of them are to
    be cut, holes first. Names lie on `labels`, to be engraved or left out. Coordinates are those of the drawing.

    Parameters
    ----------
    drawing : Drawing
    labels : sequence of Label, optional
        What is engraved; by default every part's name.

    Raises
    ------
    MissingExtraError
        If ezdxf is not installed.
    """
    ezdxf = import_ezdxf("written")
    with without_dates(ezdxf):
        return dxf_text(_document(ezdxf, drawing, labels_of(drawing.parts) if labels is None else labels))


@contextmanager
def without_dates(ezdxf: Any) -> Iterator[None]:
    """Documents that are made and written meanwhile hold no dates: the same drawing gives the same file."""
    before = ezdxf.options.write_fixed_meta_data_for_testing
    ezdxf.options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = before


def dxf_text(document: Any) -> str:
    """Text of an ezdxf document; plain ASCII."""
    stream = StringIO()
    document.write(stream)
    return _ascii(stream.getvalue())


def _document(ezdxf: Any, drawing: Drawing, labels: Sequence[Label]) -> Any:
    """Everything that is cut and engraved."""
    document = ezdxf.new("R2000")
    document.units = ezdxf.units.MM
    document.header["$MEASUREMENT"] = 1
    document.appids.add(NAME)
    for layer, colour in _LAYERS.items():
        document.layers.add(layer, color=colour)
    space = document.modelspace()
    outers: dict[str, list[Any]] = {}
    for part in drawing.parts:
        outers[part.name] = []
        for number, region in enumerate(part.regions):
            outer, *holes = placed_rings(part, region)
            line = space.add_lwpolyline(
                outer.tolist(), close=True, dxfattribs={"layer": "fixed" if part.fixed else "cut"}
            )
            chunks = [(1000, part.name[i : i + CHUNK_LENGTH]) for i in range(0, len(part.name), CHUNK_LENGTH)]
            line.set_xdata(NAME, [*chunks, (1070, number + 1), (1070, len(part.regions))])
            outers[part.name].append(line)
            for hole in holes:
                space.add_lwpolyline(hole.tolist(), close=True, dxfattribs={"layer": HOLES})
    for label in labels:
        for stroke in lettered(label):
            space.add_lwpolyline(stroke.tolist(), dxfattribs={"layer": LABELS})
    for number, names in enumerate(glued_names(drawing.glue), 1):
        with document.groups.new(f"glue-{number}").edit_data() as members:
            members.extend(line for name in names for line in outers[name])
    return document


def _ascii(text: str) -> str:
    r"""Write other letters as DXF spells them in any code page.

    Examples
    --------
    >>> _ascii("ä")
    '\\U+00E4'
    """
    if text.isascii():
        return text
    units = text.encode("utf-16-be", "surrogatepass")
    codes = [int.from_bytes(units[i : i + 2]) for i in range(0, len(units), 2)]
    return "".join(chr(code) if code < 128 else f"\\U+{code:04X}" for code in codes)
