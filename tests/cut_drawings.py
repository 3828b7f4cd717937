"""Drawings with slots, notches and reliefs, written as SVG, DXF and LightBurn, and the parts that a laser leaves of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely import Polygon
from shapely.affinity import translate

from wiggleroom.drawing.model import Drawing

HEIGHT = 200.0
LIGHTBURN_COLOURS = {"#000000": 0, "#0000ff": 1, "#ff0000": 2}
"""Layers of LightBurn by their colour."""


@dataclass(frozen=True)
class Line:
    """One drawn outline: corners (n, 2) [mm], or a circle (x, y, radius)."""

    corners: Sequence[tuple[float, float]] = ()
    circle: tuple[float, float, float] | None = None
    name: str = ""
    layer: str = ""
    colour: str = "#000000"
    closed: bool = True

    @property
    def shape(self) -> Polygon:
        """The area inside."""
        if self.circle is not None:
            x, y, r = self.circle
            return shapely.Point(x, y).buffer(r, quad_segs=400)
        return Polygon(self.corners)


def rect(x: float, y: float, w: float, h: float, name: str = "", **more: str) -> Line:
    return Line(((x, y), (x + w, y), (x + w, y + h), (x, y + h)), name=name, **more)  # type: ignore[arg-type]


def disc(x: float, y: float, r: float, name: str = "", **more: str) -> Line:
    return Line((), (x, y, r), name=name, **more)  # type: ignore[arg-type]


@dataclass(frozen=True)
class CutCase:
    """What is drawn, and what is left of it.

    Parameters
    ----------
    lines : sequence of Line
    left : sequence of polygons
        One for every part.
    noted : str
        Words of a note.
    asked : str
        Words of a finding, where the drawing does not say what is meant.
    rings : bool
        Whether the holes of each part are counted; not where a hole meets the edge in a point.
    formats : str
        The formats that can say it.
    """

    name: str
    lines: Sequence[Line]
    left: Sequence[Polygon] = ()
    noted: str = ""
    asked: str = ""
    hole: tuple[str, ...] = ()
    rings: bool = True
    formats: str = "svg dxf lbrn2"


def written(lines: Sequence[Line], path: Path) -> Path:
    """A drawing in the format of the path's extension."""
    write = {".svg": _svg, ".dxf": _dxf, ".lbrn2": _lightburn}[path.suffix]
    write(lines, path)
    return path


def _svg(lines: Sequence[Line], path: Path) -> None:
    body = []
    for line in lines:
        name = f' id="{line.name}"' if line.name else ""
        style = f'{name} style="fill:none;stroke:{line.colour};stroke-width:0.1"'
        if line.circle is not None:
            x, y, r = line.circle
            drawn = f'<circle cx="{x!r}" cy="{HEIGHT - y!r}" r="{r!r}"{style}/>'
        else:
            corners = " L ".join(f"{x!r},{HEIGHT - y!r}" for x, y in line.corners)
            drawn = f'<path d="M {corners}{" Z" if line.closed else ""}"{style}/>'
        body.append(f'<g inkscape:groupmode="layer" inkscape:label="{line.layer}">{drawn}</g>' if line.layer else drawn)
    space = 'xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
    path.write_text(f'<svg {space} width="400mm" height="{HEIGHT}mm" viewBox="0 0 400 {HEIGHT}">{"".join(body)}</svg>')


def _dxf(lines: Sequence[Line], path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new("R2010")
    document.header["$INSUNITS"] = 4
    space = document.modelspace()
    for line in lines:
        value = line.colour.lstrip("#")
        rgb = tuple(int(value[k : k + 2], 16) for k in (0, 2, 4))
        where = {"layer": line.layer or "cut", "true_color": ezdxf.colors.rgb2int(rgb)}
        if line.circle is not None:
            space.add_circle(line.circle[:2], line.circle[2], dxfattribs=where)
        else:
            space.add_lwpolyline(line.corners, close=line.closed, dxfattribs=where)
    document.saveas(path)


def _lightburn(lines: Sequence[Line], path: Path) -> None:
    layers = {(line.layer, line.colour): n for n, line in enumerate(lines)}
    layers = {key: n for n, key in enumerate(layers)} if any(line.layer for line in lines) else {}
    settings = [
        f'<CutSetting type="Cut"><index Value="{n}"/><name Value="{layer or f"C{n:02d}"}"/></CutSetting>'
        for (layer, _), n in layers.items()
    ]
    body = []
    for line in lines:
        index = layers.get((line.layer, line.colour), LIGHTBURN_COLOURS.get(line.colour, 0))
        head = f'CutIndex="{index}"' + (f' Name="{line.name}"' if line.name else "")
        if line.circle is not None:
            x, y, r = line.circle
            body.append(
                f'<Shape Type="Ellipse" {head} Rx="{r!r}" Ry="{r!r}"><XForm>1 0 0 1 {x!r} {y!r}</XForm></Shape>'
            )
            continue
        corners = "".join(f"V{x!r} {y!r}c0x1c1x1" for x, y in line.corners)
        n = len(line.corners)
        edges = "".join(f"L{k} {(k + 1) % n}" for k in range(n if line.closed else n - 1))
        inside = f"<VertList>{corners}</VertList><PrimList>{edges}</PrimList>"
        body.append(f'<Shape Type="Path" {head}><XForm>1 0 0 1 0 0</XForm>{inside}</Shape>')
    head = '<?xml version="1.0" encoding="UTF-8"?><LightBurnProject AppVersion="1.4.03" FormatVersion="1">'
    path.write_text(f"{head}{''.join(settings)}{''.join(body)}</LightBurnProject>")


def polygons(drawing: Drawing) -> list[shapely.Geometry]:
    """Material of each part, where it lies."""
    found = []
    for part in drawing.parts:
        x, y, _ = part.at
        pieces = [translate(Polygon(region.outer, region.holes), x, y) for region in part.regions]
        found.append(shapely.union_all(pieces))
    return found


def assert_left(drawing: Drawing, left: Sequence[Polygon], slack: float, *, rings: bool = True) -> None:
    """Each expected part is there, and no other: areas of the symmetric differences [mm2] against `slack` times the length."""
    found = polygons(drawing)
    assert all(shapely.is_valid(found)), "a part is invalid"
    assert len(found) == len(left), (len(found), len(left), drawing.notes)
    rest = list(range(len(found)))
    for want in left:
        differences = [shapely.area(want.symmetric_difference(found[k])) for k in rest]
        best = int(np.argmin(differences))
        assert differences[best] <= slack * want.length, (differences[best], want.area, drawing.notes)
        got = found[rest.pop(best)]
        assert not rings or sum(len(p.interiors) for p in shapely.get_parts(got)) == sum(
            len(p.interiors) for p in shapely.get_parts(want)
        )
