"""Open: a drawing from the bytes of a file, and what the page is told about it."""

from __future__ import annotations

import dataclasses
import json
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath, PureWindowsPath

import msgspec
import numpy as np
import shapely
from msgspec.structs import replace

from wiggleroom.app.made_drawing import made_file
from wiggleroom.app.reporter import on_the_page
from wiggleroom.app.samples import sample_file
from wiggleroom.assembly.assembly import place, rings_at
from wiggleroom.drawing.dimension import PUZZLES, is_spatial_file
from wiggleroom.drawing.model import Drawing, Flattening, JointGap
from wiggleroom.drawing.read import READERS, read_drawing
from wiggleroom.drawing.readers.source import load
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.drawing.writers.boxes_writer import write_boxes
from wiggleroom.errors import InputError
from wiggleroom.report.page.page_messages import design_message, drawing_message
from wiggleroom.schema.replies import Opened
from wiggleroom.schema.requests import GoalEntry, HowRead, Made, OpenRequest

NEAR_SHARE = 0.01
"""Parts nearer to each other than this share of a usual part's side do not lie apart."""
CRUMB_SHARE = 0.01
"""What is smaller than this share of the largest part is a dot of the drawing rather than a part that somebody pulls."""


@dataclass(frozen=True, eq=False)
class File:
    """The drawing that is open.

    Parameters
    ----------
    name : str
        Without folders.
    path : str
        What commands call it.
    drawing : Drawing
        As the file says it.
    unit : str or None
        In place of the file's.
    flatten : float or None [mm]
        How finely curves were flattened, whatever gap is tried; None where there are none.
    flattening : Flattening or None
        How commands flatten them at a gap, where they are not told.
    text : str
        Of a file in space, as it is.
    data : bytes
        Of a drawing, as it is: it may be a cutting sheet.
    options : ReadOptions
        What is read of a drawing.
    joints : tuple of JointGap
        Gaps of single joints that stand in the file itself.
    ignored : tuple of str
        Options of commands that say pairs to ignore that are not in the file.
    made : Made or None
        How it was made here.
    """

    name: str
    path: str
    drawing: Drawing
    unit: str | None = None
    flatten: float | None = None
    flattening: Flattening | None = None
    text: str = ""
    data: bytes = b""
    options: ReadOptions = dataclasses.field(default_factory=ReadOptions)
    joints: tuple[JointGap, ...] = ()
    ignored: tuple[str, ...] = ()
    made: Made | None = None


def opened(request: OpenRequest) -> File:
    """Read what the page sent, in a folder that is gone afterwards.

    Raises
    ------
    InputError
        With one line per finding; names of folders are left out.
    """
    if request.sample:
        name = plain_name(f"{request.name}.json")
        return opened(replace(request, name=name, path=saved_name(name), data=sample_file(request.name), sample=False))
    if request.make is not None:
        name = f"{request.make.pattern}.json"
        as_file = replace(request, name=name, path=saved_name(name), data=made_file(request.make), make=None)
        return dataclasses.replace(opened(as_file), made=request.make)
    name = plain_name(request.name)
    with temporary_file(name) as path:
        if path.suffix.lower() in (*READERS, *PUZZLES):
            path.write_bytes(request.data)
        if path.suffix.lower() in PUZZLES:
            return _puzzle(path, request)
        if is_spatial_file(path):
            return _in_space(path, request)
        read = _read(path, request)
        drawing, ignored = _with_joints(read, request)
    how = drawing.flattening
    flatten = request.flatten if how is None else how.error
    if path.suffix.lower() == ".json":
        flatten = None
    same = dataclasses.replace(drawing, flattening=None)  # outlines on screen stay as they are while the gap is dragged
    return File(
        name,
        request.path or name,
        same,
        request.unit,
        flatten,
        how,
        data=request.data,
        options=_options(request),
        joints=read.gaps,
        ignored=ignored,
    )


@contextmanager
def temporary_file(name: str) -> Iterator[Path]:
    """A place for a file of this name, in a folder that is gone afterwards and that no finding names."""
    with tempfile.TemporaryDirectory(prefix="wiggleroom-") as folder:
        try:
            yield Path(folder) / name
        except InputError as problem:
            raise InputError([line.replace(f"{folder}/", "") for line in problem.findings]) from None


def first_open(
    path: Path,
    drawing: Drawing,
    unit: str | None,
    flatten: float | None,
    gap: float | None,
    options: ReadOptions | None = None,
) -> bytes:
    """The request that opens a file of this machine with what the options of a command made of its drawing."""
    design = design_message(drawing)
    data = path.read_bytes()
    how = options or ReadOptions()
    return msgspec.json.encode(
        OpenRequest(
            id=0,
            name=path.name,
            path=str(path),
            data=data,
            unit=unit,  # type: ignore[arg-type]
            flatten=flatten,
            gap=gap,
            only=how.only,
            skip=how.skip,
            join=how.join,
            solid=how.solid,
            hole=how.hole,
            gaps=_gaps_of(drawing),
            ignore=list(drawing.ignore),
            design=design,
        )
    )


def saved_name(name: str, ending: str = "-design.json") -> str:
    """Name of what is saved of a drawing of this name."""
    return PurePosixPath(name).stem + ending


def plain_name(name: str) -> str:
    r"""Name of a file without folders and without what no name should hold.

    >>> plain_name("../../etc/a b.svg"), plain_name("C:\\x\\y.dxf"), plain_name("..")
    ('a b.svg', 'y.dxf', 'drawing')
    """
    last = PureWindowsPath(PurePosixPath(name).name).name
    kept = "".join(c for c in last if c.isprintable() and c not in '<>:"|?*').strip()
    if kept in ("", ".", ".."):
        return "drawing"
    stem, suffix = PurePosixPath(kept).stem, PurePosixPath(kept).suffix
    return stem[:80] + suffix[:8]


def _in_space(path: Path, request: OpenRequest) -> File:
    """An assembly in space; of what it names beside itself only what came with it is opened."""
    if request.unit is not None or request.flatten is not None:
        message = f"{path.name}: unit and flatten are about drawings; an assembly in space says its own unit"
        raise InputError(message)
    for name, data in request.beside.items():
        other = (path.parent / name).resolve()
        if not other.is_relative_to(path.parent.resolve()) or other == path.resolve():
            message = f'{path.name}: "{name[:60]}" must lie in the folder of the assembly file or below it'
            raise InputError(message)
        other.parent.mkdir(parents=True, exist_ok=True)
        other.write_bytes(data)
    from wiggleroom.spatial.solids.spatial_file import read_spatial  # slow to import, and of no use to drawings

    read = read_spatial(path, alone=not request.beside)
    drawing, ignored = _with_joints(read, request)
    if request.gap is not None:
        drawing = dataclasses.replace(drawing, gap=request.gap)
    text = load(path, opening="{", name="assembly").text
    return File(path.name, request.path or path.name, drawing, text=text, joints=read.gaps, ignored=ignored)


def _puzzle(path: Path, request: OpenRequest) -> File:
    """A voxel puzzle, as the boxes that the page works on."""
    from wiggleroom.drawing.readers.voxel_puzzle import read_puzzle

    drawing = read_puzzle(path)
    boxes = replace(
        request, name=f"{path.stem}.json", path=request.path or path.name, data=write_boxes(drawing).encode()
    )
    found = opened(boxes)
    return dataclasses.replace(found, name=path.name, drawing=dataclasses.replace(found.drawing, notes=drawing.notes))


def _with_joints(drawing: Drawing, request: OpenRequest) -> tuple[Drawing, tuple[str, ...]]:
    """The drawing with gaps of joints and pairs to ignore as the request says, and the options of commands that say these pairs.

    Raises
    ------
    InputError
        If it names parts that are not there.
    """
    from wiggleroom.assembly.statements import unknown

    gaps = drawing.gaps if request.gaps is None else tuple(JointGap((a, b), gap) for a, b, gap in request.gaps)
    ignore = drawing.ignore if request.ignore is None else tuple(request.ignore)
    names = {p.name: None for p in drawing.parts}
    pairs = [("gaps", joint.parts) for joint in gaps] + [("ignore", pair) for pair in ignore]
    wrong = [f"{what}: {unknown(name, names)}" for what, pair in pairs for name in pair if name not in names]
    if wrong:
        raise InputError(wrong)
    said = [word for pair in ignore if pair not in drawing.ignore for word in ("--ignore", ",".join(pair))]
    return dataclasses.replace(drawing, gaps=gaps, ignore=ignore), tuple(said)


def _gaps_of(drawing: Drawing) -> list[tuple[str, str, float]]:
    """Gaps of single joints, as a request says them."""
    return [(*joint.parts, joint.gap) for joint in drawing.gaps]


def first_open_in_space(path: Path, drawing: Drawing) -> bytes:
    """The request that opens an assembly in space of this machine, and the files that it names, with what a command made of it."""
    from wiggleroom.report.page.page_messages import design_message

    data, named = path.read_bytes(), []
    if path.suffix.lower() not in PUZZLES:
        named = [part.get(key) for part in json.loads(data)["parts"] for key in ("mesh", "outline")]
    files = dict.fromkeys(name.partition("#")[0] for name in named if isinstance(name, str))
    return msgspec.json.encode(
        OpenRequest(
            id=0,
            name=path.name,
            path=str(path),
            data=data,
            beside={name: (path.parent / name).read_bytes() for name in files},
            gaps=_gaps_of(drawing),
            ignore=list(drawing.ignore),
            design=design_message(drawing),
        )
    )


def _options(request: OpenRequest) -> ReadOptions:
    return ReadOptions(request.only, request.skip, request.join, request.solid, hole=request.hole)


def _read(path: Path, request: OpenRequest) -> Drawing:
    if path.suffix.lower() == ".json":
        return read_drawing(path, unit=request.unit, gap=request.gap)
    return read_drawing(path, unit=request.unit, flatten=request.flatten, gap=request.gap, options=_options(request))


def opened_reply(file: File, drawing: Drawing) -> Opened:
    """Reply to `open`: parts as drawn, in world coordinates, and what is asked, as a design."""
    reply = drawing_message(drawing, drawing.parts, file.name)
    if not drawing.goals and len(drawing.parts) > 1:
        reply.pulled = suggested(drawing)
    if file.made is not None:
        reply.made = file.made
    reply.apart = lies_apart(drawing)
    reply.notes = [on_the_page(note.removeprefix(f"{file.name}: ")) for note in reply.notes]
    if PurePosixPath(file.name).suffix.lower() != ".json":
        how = file.options
        reply.reading = HowRead(file.unit, list(how.only), list(how.skip), how.join, list(how.solid), list(how.hole))  # type: ignore[arg-type]
    return reply


def lies_apart(drawing: Drawing) -> bool:
    """Whether no part is near another one or in a hollow of it, as on a cutting sheet."""
    hulls = np.array([shapely.convex_hull(shapely.multipoints(np.vstack(rings_at(part)))) for part in drawing.parts])
    if len(hulls) < 2:
        return False
    near = NEAR_SHARE * float(np.median(np.sqrt(shapely.area(hulls))))
    a, b = shapely.STRtree(hulls).query(hulls, predicate="dwithin", distance=near)
    return bool(np.all(a == b))


def suggested(drawing: Drawing) -> GoalEntry:
    """A pull for a drawing that asks for none: the part farthest from what is fixed, away from it; no crumb where there are others."""
    middle = np.array([np.vstack([r.outer for r in p.regions]).mean(axis=0) for p in drawing.parts])
    centres = np.array([place(m[None], p.at)[0] for m, p in zip(middle, drawing.parts, strict=True)])
    fixed = np.array([p.fixed for p in drawing.parts])
    if not fixed.any():
        reach = [np.ptp(np.vstack([r.outer for r in p.regions]), axis=0).max() for p in drawing.parts]
        fixed[int(np.argmax(reach))] = True
    away = centres - centres[fixed].mean(axis=0)
    sides = np.array([np.ptp(np.vstack([r.outer for r in p.regions]), axis=0).max() for p in drawing.parts])
    crumb = sides < CRUMB_SHARE * sides.max()
    far = np.where(fixed, -1.0, np.where(crumb, 0.0, np.hypot(*away.T)))
    k = int(far.argmax())
    along = int(np.abs(away[k]).argmax())
    sign = 1.0 if away[k, along] >= 0 else -1.0
    return GoalEntry(drawing.parts[k].name, direction=(sign, 0.0) if along == 0 else (0.0, sign))
