"""Walk the model space of a DXF: which strokes are drawn, where, on which layer and in which blocks."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field, replace
from typing import Any

from wiggleroom.drawing.limits import LARGEST
from wiggleroom.drawing.readers.dxf_curves import STROKES, stroke_of
from wiggleroom.drawing.strokes.elements import MAX_ELEMENTS, NO_SIZE, Group, Lettering, Stroke
from wiggleroom.drawing.strokes.layers import LABELS, is_hole_layer
from wiggleroom.drawing.strokes.strokes import largest_coordinate, mapped
from wiggleroom.drawing.strokes.transforms import Affine
from wiggleroom.errors import InputError, Stop, StoppedError, go_on

NAME = "WIGGLEROOM"
"""Extended data of this application hold a part's name, the number of this outline and how many there are."""
HOLES = "holes"
"""Outlines that we write on this layer are holes of the part around them."""
HIDDEN_LAYERS = ("defpoints", LABELS)
TEXT_KINDS = ("TEXT", "MTEXT")
IGNORED_KINDS = ("VIEWPORT", "ATTDEF", "ATTRIB", "SEQEND")
_SPELLED = re.compile(r"\\U\+([0-9A-Fa-f]{4})")
MAX_NESTING = 50
"""Blocks inside each other at most."""
TILT_TOLERANCE = 1e-5
"""An entity that is foreshortened by more than this share is not in the drawing's plane."""


@dataclass(frozen=True, slots=True)
class _DxfState:
    """What an entity inherits from the blocks that it is in."""

    matrix: Any
    layer: str = "0"
    groups: tuple[Group, ...] = ()
    colour: str = ""
    place: tuple[int, ...] = ()
    blocks: tuple[str, ...] = ()
    insert: Any = None


@dataclass
class DxfWalk:
    """Strokes, texts, notes and findings of one drawing; `scale` is the length of its unit [mm].

    `origins` hold the entity of every stroke, and the insert in the model space that shows it, if one does.
    """

    file: str
    document: Any
    scale: float
    stop: Stop | None = None
    strokes: list[Stroke] = field(default_factory=list)
    origins: list[tuple[Any, Any]] = field(default_factory=list)
    texts: list[Lettering] = field(default_factory=list)
    findings: list[str] = field(default_factory=list)
    left_out: Counter[str] = field(default_factory=Counter)
    hidden: set[str] = field(default_factory=set)

    def run(self) -> None:
        """Collect everything that the model space shows."""
        from ezdxf.math import Matrix44

        self._visited = 0
        self._copies = 0
        self._layers: dict[str, Group] = {}
        self._off = {layer.dxf.name.lower() for layer in self.document.layers if layer.is_off() or layer.is_frozen()}
        self._grouped: dict[str, Group] = {}
        for name, members in self.document.groups:
            group = Group("" if name.startswith("*") else name, name.lower().startswith("glue"))
            self._grouped |= dict.fromkeys(members.handles(), group)
        s = self.scale
        self._entities(self.document.modelspace(), _DxfState(Matrix44.scale(s, s, s)))

    def _entities(self, layout: Any, state: _DxfState) -> None:
        for entity in layout:
            go_on(self.stop)
            self._count()
            if not entity.dxf.is_supported("layer"):
                self.left_out[decoded_text(entity.dxftype()) or "nameless"] += 1  # a kind that ezdxf does not know
                continue
            own = decoded_text(str(entity.dxf.get("layer", "0")))
            layer = state.layer if own == "0" else own
            if layer.lower() in HIDDEN_LAYERS:
                continue
            if entity.dxf.get("invisible", 0):
                self.left_out[f"hidden {entity.dxftype()}"] += 1
                continue
            if layer.lower() in self._off:
                self.hidden.add(layer)
                continue
            self._guarded(entity, replace(state, layer=layer))

    def _guarded(self, entity: Any, state: _DxfState) -> None:
        """Damaged entities fail in as many ways as ezdxf has lines; each becomes one finding."""
        try:
            self._entity(entity, state)
        except (InputError, StoppedError):
            raise
        except Exception as error:
            reason = " ".join(str(error).split())[:160] if isinstance(error, ValueError) else "cannot be read"
            handle = entity.dxf.get("handle") or "?"
            named = f'{entity.dxftype()} #{handle} on layer "{state.layer}"'
            self.findings.append(f"{self.file}: {named}: {reason}")

    def _count(self) -> None:
        self._visited += 1
        if self._visited > MAX_ELEMENTS:
            message = f"{self.file}: draws more than {MAX_ELEMENTS} elements, copies counted; split the drawing"
            raise InputError(message)

    def _entity(self, entity: Any, state: _DxfState) -> None:
        kind = entity.dxftype()
        if kind in IGNORED_KINDS:
            return
        if kind == "POINT":
            self.left_out[NO_SIZE] += 1
            return
        if kind == "INSERT":
            self._insert(entity, state)
        elif kind in TEXT_KINDS:
            self._text(entity, state)
        elif kind == "HATCH":
            self.left_out[f'HATCH (filled, on layer "{state.layer}")'] += 1
        elif kind not in STROKES or (kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline)):
            self.left_out[kind] += 1
        elif abs(entity.dxf.get("extrusion", (0, 0, 1))[2]) < 1 - TILT_TOLERANCE and kind not in ("LINE", "SPLINE"):
            self.left_out[f"tilted {kind}"] += 1
        else:
            self._stroke(entity, state)

    def _stroke(self, entity: Any, state: _DxfState) -> None:
        handle = "#" + (entity.dxf.get("handle") or "?")
        named = f'{entity.dxftype()} {handle} on layer "{state.layer}"'
        path = stroke_of(entity)
        if path is None:
            self.left_out[NO_SIZE] += 1
            return
        in_plane = entity.dxftype() in ("ARC", "CIRCLE", "LWPOLYLINE") or (
            entity.dxftype() == "POLYLINE" and entity.is_2d_polyline
        )
        path = mapped(path, _affine(state.matrix, entity.ocs() if in_plane else None))
        if not largest_coordinate(path) <= LARGEST:
            self.findings.append(f"{self.file}: {named}: has coordinates beyond {LARGEST:g} mm; move or scale it")
            return
        groups = self._groups_of(entity, state)
        piece = _piece(entity)
        self.strokes.append(
            Stroke(
                tag=entity.dxftype(),
                place=f'layer "{state.layer}" ({handle})',
                paths=(path,),
                label=piece[0] if piece else "",
                groups=groups,
                layer=state.layer,
                colour=self._colour(entity, state),
                line_type=self._line_type(entity, state),
                fixed=any(group.name.lower() == "fixed" for group in groups),
                even_odd=True,
                hole=is_hole_layer(state.layer),
                piece=piece,
                pool=(state.layer.lower(), *state.place),
            )
        )
        self.origins.append((entity, state.insert))

    def _colour(self, entity: Any, state: _DxfState) -> str:
        """Colour of an entity, of its layer or of its block, as `#rrggbb`."""
        from ezdxf.colors import aci2rgb, int2rgb

        if entity.dxf.hasattr("true_color"):
            return _hex(int2rgb(entity.dxf.true_color))
        code = int(entity.dxf.get("color", 256))
        if code == 0:
            return state.colour or "#000000"  # of the block; outside any, black
        if code == 256 and state.layer in self.document.layers:
            layer = self.document.layers.get(state.layer)
            if layer.dxf.hasattr("true_color"):
                return _hex(int2rgb(layer.dxf.true_color))
            code = abs(int(layer.dxf.get("color", 7)))
        if not 0 < code < 256 or code == 7:
            return "#000000"  # white on a black screen, black on paper
        return _hex(aci2rgb(code))

    def _line_type(self, entity: Any, state: _DxfState) -> str:
        """Line type of an entity or of its layer by name; nothing where it has no gaps."""
        name = str(entity.dxf.get("linetype", "BYLAYER"))
        if name.upper() == "BYLAYER" and state.layer in self.document.layers:
            name = str(self.document.layers.get(state.layer).dxf.get("linetype", ""))
        return "" if name.upper() in ("BYLAYER", "BYBLOCK", "CONTINUOUS", "") else name

    def _groups_of(self, entity: Any, state: _DxfState) -> tuple[Group, ...]:
        key = state.layer.lower()
        plain = key == "0" or is_hole_layer(key)
        layer = self._layers.setdefault(
            key, Group("" if plain else state.layer, key.startswith("glue"), (state.layer,))
        )
        grouped = self._grouped.get(entity.dxf.get("handle"))
        return (layer, *((grouped,) if grouped else ()), *state.groups)

    def _insert(self, insert: Any, state: _DxfState) -> None:
        name = decoded_text(insert.dxf.get("name", ""))
        named = f'block "{name}" on layer "{state.layer}"'
        block = insert.block()
        if block is None or name in state.blocks or len(state.blocks) > MAX_NESTING:
            reason = "is not in the file" if block is None else "holds itself" if name in state.blocks else ""
            self.findings.append(f"{self.file}: {named}: {reason or 'is nested too deep'}; explode it or draw it once")
            return
        if block.block is not None and block.block.is_xref:
            self.left_out[f'external reference "{name}"'] += 1
            return
        if abs(insert.dxf.extrusion.z) < 1 - TILT_TOLERANCE:
            self.left_out["tilted INSERT"] += 1
            return
        if insert.mcount > MAX_ELEMENTS:
            self.findings.append(f"{self.file}: {named}: has more than {MAX_ELEMENTS} copies; it must have fewer")
            return
        grouped = self._grouped.get(insert.dxf.get("handle"))
        for copy in insert.multi_insert() if insert.mcount > 1 else (insert,):
            self._count()
            self._copies += 1
            group = Group("" if name.startswith("*") else name, name.lower().startswith("glue"))
            inner = _DxfState(
                matrix=copy.matrix44() @ state.matrix,
                layer=state.layer,
                colour=self._colour(insert, state),
                groups=(*state.groups, *((grouped,) if grouped else ()), group),
                place=(*state.place, self._copies),
                blocks=(*state.blocks, name),
                insert=state.insert or insert,
            )
            self._entities(block, inner)

    def _text(self, entity: Any, state: _DxfState) -> None:
        """Keep a short text and the point it stands at: it may name a part."""
        if entity.dxftype() == "TEXT":
            _, first, second = entity.get_placement()
            content, point = entity.plain_text(), second if second is not None else first
        else:
            content, point = entity.plain_text(), entity.dxf.insert
        at = _affine(state.matrix, entity.ocs() if entity.dxftype() == "TEXT" else None).point(
            complex(point[0], point[1])
        )
        words = decoded_text(" ".join(content.split()))
        if words:
            self.texts.append(Lettering(words, at))


def decoded_text(value: str) -> str:
    r"""Text as people wrote it: letters spelled \U+00E4 joined, what cannot be shown replaced.

    Examples
    --------
    >>> decoded_text("\\U+00E4")
    'ä'
    """
    value = _SPELLED.sub(lambda match: chr(int(match.group(1), 16)), value)
    return value.encode("utf-16", "surrogatepass").decode("utf-16", "replace")


def _affine(matrix: Any, ocs: Any) -> Affine:
    """Map of an entity's plane to the page, which leaves heights out."""
    across, up, origin = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0)
    if ocs is not None and ocs.transform:
        across, up = ocs.to_wcs(across), ocs.to_wcs(up)
    x, y, o = matrix.transform_direction(across), matrix.transform_direction(up), matrix.transform(origin)
    return Affine(x[0], x[1], y[0], y[1], o[0], o[1])


def _piece(entity: Any) -> tuple[str, int, int] | None:
    """Name of the part, number of this outline and how many there are, where the file says so."""
    if not entity.has_xdata(NAME):
        return None
    tags = entity.get_xdata(NAME)
    name = "".join(str(tag.value) for tag in tags if tag.code == 1000)
    numbers = [int(tag.value) for tag in tags if tag.code == 1070]
    if not name or not decoded_text(name).isprintable() or len(numbers) != 2:
        return None
    return decoded_text(name), numbers[0], numbers[1]


def _hex(colour: Any) -> str:
    return "#" + "".join(f"{int(part):02x}" for part in tuple(colour)[:3])
