"""Read a mesh from a file: closed, outward, in millimetres; small faults are mended and said."""

from __future__ import annotations

import json
import logging
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.dimension import MESHES
from wiggleroom.drawing.model import Surface
from wiggleroom.errors import InputError, Stop, go_on
from wiggleroom.spatial.solids.convex_hulls import filled_up, hull_surface
from wiggleroom.spatial.solids.file_digits import coordinate_step, coordinates_as_written
from wiggleroom.spatial.solids.mesh_pieces import convex_pieces
from wiggleroom.spatial.solids.rounded_corners import FURTHEST, STEPS, with_flat_faces
from wiggleroom.spatial.solids.self_crossing import self_crossing
from wiggleroom.spatial.solids.solid_boolean import (
    SAME_SOLID,
    centroid_of,
    connected_solids,
    is_solid_of,
    is_sound,
    is_whole,
    lacks_slits_only,
    solid_of,
    surface_of,
    turned_over,
    union_of,
    volume_of,
)
from wiggleroom.spatial.solids.step_file import step_bodies

logging.getLogger("trimesh").addHandler(logging.NullHandler())  # else Python prints what the library logs

OWN_UNIT = {".glb": 1000.0, ".3mf": None}
"""Millimetres to a unit of the formats that say their own; 3MF says it in the file."""
UNITS_3MF = {"micron": 1e-3, "millimeter": 1.0, "centimeter": 10.0, "inch": 25.4, "foot": 304.8, "meter": 1000.0}
OBJ: dict[str, Any] = {"group_material": False, "skip_materials": True}
"""What is of another colour is no body of an OBJ file."""
STEP = (".step", ".stp")
"""Read by the extra `step`, in the file's own unit."""
LARGEST_FILE = 100_000_000
"""Larger files are refused [bytes]."""
LARGEST_UNPACKED = 400_000_000
"""And so are archives that hold more [bytes]."""
MAX_FACES = 200_000
"""And meshes of more faces."""
MERGED = 1e-6
"""Corners nearer than this share of the size are one."""
SAME_VOLUME = 1e-9
"""Volumes that differ by less than this share are those of the same solid."""
SLIVER = 1e-4
"""Two faces that lie on each other and are narrower than this share of the size are a sliver that merged corners folded flat, and a
surface that crosses itself by less encloses slivers only."""
AS_ONE = "they move as one"
PLAUSIBLE = (1.0, 5000.0)
"""Of meshes whose largest is smaller or larger than this, in a unit that their file does not say, the unit is asked about [mm]."""
SAME_PLACE = 1e-7
"""Surfaces cross each other by more than this share of the size."""
OPEN_SHARE = 0.02
"""Largest share of the edges that may lie at tiny holes that are closed."""


class MeshFiles:
    """Mesh files, each of which is read once, whatever is asked of it.

    Parameters
    ----------
    unit : float [mm]
        One unit of formats that say none: STL, OBJ, PLY.
    stop : optional
        Anything with `is_set()`: then reading ends with a StoppedError.
    """

    def __init__(self, unit: float, stop: Stop | None = None) -> None:
        self._unit, self._stop = unit, stop
        self._files: dict[Path, tuple[dict[str, tuple[Any, float]], float]] = {}
        self._surfaces: dict[tuple[Path, str], tuple[Surface, list[str]]] = {}
        self._separate: dict[tuple[Path, str], list[Surface]] = {}

    def read(self, path: Path, body: str = "") -> tuple[Surface, list[str]]:
        """Closed surface [mm] of a file, or of one body of it, and notes about what was mended.

        Parameters
        ----------
        path : Path
        body : str
            Name of a body of a file with several; a number, alone or after that name and #: which of its disjoint solids, the largest
            is 1.

        Raises
        ------
        InputError
            If there is no such file or body, or the mesh encloses no volume.
        """
        names = list(self._bodies(path)[0])
        if body in names or not body:
            return self._surface(path, body if body else self._only(path, names))
        name, _, number = body.rpartition("#")
        name = name or (names[0] if len(names) == 1 else "")
        if name not in names or not number.isdecimal():
            raise self._missing(path, body, names)
        surface, notes = self._surface(path, name)
        solids = self._solids(path, name, surface)
        if not 1 <= int(number) <= len(solids):
            raise self._missing(path, body, [str(k + 1) for k in range(len(solids))])
        return solids[int(number) - 1], [note for note in notes if not note.endswith(AS_ONE)]

    @property
    def unit_in_doubt(self) -> str:
        """A line where what was read in the unit given is all so small or so large that another one may be meant; else an empty text."""
        read = [
            (float(np.ptp(surface.vertices, axis=0).max()), path.name)
            for (path, _), (surface, _) in self._surfaces.items()
            if path.suffix.lower() in (".stl", ".obj", ".ply")
        ]
        size, name = max(read, default=(PLAUSIBLE[0], ""))
        if PLAUSIBLE[0] <= size <= PLAUSIBLE[1]:
            return ""
        return f"{name}: is {size:.3g} mm large; the file says no unit, so if that is wrong give another one"

    def bodies(self, path: Path) -> tuple[dict[str, Surface], list[str]]:
        """Surfaces [mm] of all bodies and disjoint solids of a file, by what they are called after its name; and notes."""
        names = list(self._bodies(path)[0])
        found: dict[str, Surface] = {}
        said: list[str] = []
        for name in names:
            surface, notes = self._surface(path, name)
            said += [note for note in notes if not note.endswith(AS_ONE)]
            solids = self._solids(path, name, surface)
            head = "" if len(names) == 1 else f"#{name}"
            found |= {f"{head}#{k + 1}" if len(solids) > 1 else head: one for k, one in enumerate(solids)}
        return found, [*said, *filter(None, [self.unit_in_doubt])]

    def _bodies(self, path: Path) -> tuple[dict[str, tuple[Any, float]], float]:
        """Meshes of a file by name, each with the step of its coordinates, or how far it lies from curved faces; and the unit [mm]."""
        if path not in self._files:
            ending = path.suffix.lower()
            if ending not in MESHES:
                message = f"{path.name}: no mesh format that is read; it must be one of {', '.join(MESHES)}"
                raise InputError(message)
            _check_size(path, ending)
            if ending in STEP:
                solids = {name: ((v, f), flattened) for name, (v, f, flattened) in step_bodies(path).items()}
                self._files[path] = solids, 1.0
            else:
                meshes, scale = _bodies(path, ending)
                self._files[path] = meshes, self._unit if ending not in OWN_UNIT else OWN_UNIT[ending] or scale
        return self._files[path]

    def _surface(self, path: Path, body: str) -> tuple[Surface, list[str]]:
        go_on(self._stop)
        if (path, body) not in self._surfaces:
            bodies, unit = self._bodies(path)
            mesh, step = bodies[body]
            name = f"{path.name}#{body}" if len(bodies) > 1 else path.name
            if path.suffix.lower() in STEP:
                surface, notes = _closed(name, *mesh)
                notes = ([f"{name}: curved faces are flattened to {step:.3g} mm"] if step else []) + notes
            else:
                corners, faces = np.asarray(mesh.vertices, float) * unit, np.asarray(mesh.faces, dtype=np.int64)
                surface, notes = _closed(name, corners, faces)
                go_on(self._stop)
                surface, notes = _as_drawn(name, surface, notes, step * unit)
                surface, notes = _uncrossed(name, surface, notes, step * unit, self._stop)
            self._surfaces[path, body] = surface, notes
        return self._surfaces[path, body]

    def _solids(self, path: Path, body: str, surface: Surface) -> list[Surface]:
        """Disjoint solids, the largest first; of those that are equally large, those at the least x, y, z first."""
        if (path, body) not in self._separate:
            whole = solid_of(surface)
            solids = connected_solids(whole)
            size = float(np.ptp(surface.vertices, axis=0).max())
            surfaces = [surface_of(solid) for solid in solids] if len(solids) > 1 else [surface]

            def order(one: Surface) -> tuple[float, ...]:
                volume, middle = centroid_of(one)
                return -round(volume / whole.volume(), 6), *(middle / size).round(6).tolist()

            self._separate[path, body] = sorted(surfaces, key=order)
        return self._separate[path, body]

    def _only(self, path: Path, names: list[str]) -> str:
        if len(names) > 1:
            message = f'{path.name}: has {len(names)} bodies; name one as "{path.name}#NAME": {_listed(names)}'
            raise InputError(message)
        return names[0]

    def _missing(self, path: Path, body: str, names: list[str]) -> InputError:
        return InputError(f'{path.name}: there is no body "{body}"; the bodies are {_listed(names)}')


def _listed(names: list[str]) -> str:
    return ", ".join(f'"{name}"' for name in names[:8])


def _as_drawn(name: str, surface: Surface, notes: list[str], step: float) -> tuple[Surface, list[str]]:
    """The surface with what the digits of its file explain put right: flat faces, and dents of what is convex but for them."""
    flat, moved = with_flat_faces(surface, step)
    again = solid_of(flat) if moved else None
    if again is not None and is_sound(again) and is_whole(again, flat):
        surface = flat
        notes = [*notes, f"{name}: corners are put back into the planes of their faces, by at most {moved:.1g} mm"]
    filled = filled_up(surface, FURTHEST * step)
    if filled is not None and volume_of(filled[0]) > (1 + SAME_VOLUME) * volume_of(surface):
        surface = filled[0]
        notes = [
            *notes,
            f"{name}: is convex to the digits of the file; dents of at most {filled[1]:.1g} mm are filled up",
        ]
    return surface, notes


def _uncrossed(
    name: str, surface: Surface, notes: list[str], step: float, stop: Stop | None
) -> tuple[Surface, list[str]]:
    """A surface that crosses itself by no more than a sliver as it is; else that of what it encloses, by convex pieces.

    Raises
    ------
    InputError
        If it has none: some of it is inside out, or it has too many.
    """
    size = float(np.ptp(surface.vertices, axis=0).max())
    near = max(STEPS * step, SAME_PLACE * size)
    at = self_crossing(surface, near, stop)
    if at is None:
        return surface, notes
    where = f"({at[0]:.4g}, {at[1]:.4g}, {at[2]:.4g})"
    while near < SLIVER * size:
        near = min(10 * near, SLIVER * size)
        if self_crossing(surface, near, stop) is None:
            return surface, [
                *notes,
                f"{name}: crosses itself at {where} by less than {near:.1g} mm; the part is as drawn",
            ]
    pieces = convex_pieces(solid_of(surface), stop)
    if pieces is None:
        message = f"{name}: crosses itself at {where}; mend the mesh"
        raise InputError(message)
    whole = union_of([solid_of(hull_surface(piece.corners)) for piece in pieces])
    return surface_of(whole), [*notes, f"{name}: crosses itself at {where}; the part is what it encloses"]


def _check_size(path: Path, ending: str) -> None:
    try:
        size = path.stat().st_size
    except OSError:
        message = f"{path.name}: there is no such file; check its name, and that it lies beside the assembly file"
        raise InputError(message) from None
    if not path.is_file():
        message = f"{path.name}: is not a file; give the name of a mesh file"
        raise InputError(message)
    if size == 0:
        message = f"{path.name}: is empty; a mesh is needed"
        raise InputError(message)
    if size > LARGEST_FILE:
        message = f"{path.name}: has {size / 1e6:.0f} MB; at most {LARGEST_FILE / 1e6:.0f} MB are read"
        raise InputError(message)
    if ending == ".3mf":
        try:
            with zipfile.ZipFile(path) as archive:
                unpacked = sum(entry.file_size for entry in archive.infolist())
        except (zipfile.BadZipFile, OSError):
            message = f"{path.name}: is not a 3MF archive; save it again"
            raise InputError(message) from None
        if unpacked > LARGEST_UNPACKED:
            message = (
                f"{path.name}: unpacks to {unpacked / 1e6:.0f} MB; at most {LARGEST_UNPACKED / 1e6:.0f} MB are read"
            )
            raise InputError(message)


def _check_is_whole(path: Path) -> None:
    """Refuse a GLB file that takes buffers or pictures from other files."""
    data = path.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    try:
        tree = json.loads(data[20 : 20 + length])
        links = [str(entry["uri"]) for key in ("buffers", "images") for entry in tree.get(key, ()) if entry.get("uri")]
    except (ValueError, AttributeError, TypeError, KeyError, RecursionError):
        return  # no GLB file: the library says what is wrong
    outside = [link for link in links if not link.lower().startswith("data:")]
    if outside:
        message = f'{path.name}: takes "{outside[0][:40]}" from another file; save it as one file'
        raise InputError(message)


@np.errstate(all="ignore")  # coordinates that are no numbers, or far too large, are refused in one line afterwards
def _bodies(path: Path, ending: str) -> tuple[dict[str, tuple[Any, float]], float]:
    """Meshes of a file by name, placed as the file places them, and the step of their coordinates; and the file's unit [mm]."""
    import trimesh

    if ending == ".glb":
        _check_is_whole(path)
    try:
        with path.open("rb") as file:  # without the path the library finds no other file
            scene = (
                _obj_scene(file) if ending == ".obj" else trimesh.load_scene(file, file_type=ending[1:], process=False)
            )
    except Exception as problem:  # the library raises whatever its readers raise
        reason = " ".join(str(problem).split())[:80] or type(problem).__name__
        message = f"{path.name}: cannot be read as {ending[1:].upper()} ({reason}); save it again"
        raise InputError(message) from None
    written = coordinates_as_written(path)
    found: dict[str, tuple[Any, float]] = {}
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        mesh = scene.geometry[name]
        if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
            continue
        label = str(name)
        while label in found:
            label = f"{label}'"
        step = coordinate_step(written, mesh.vertices) * float(np.linalg.norm(transform[:3, :3], 2))
        found[label] = mesh.copy().apply_transform(transform), step
    if not found:
        unplaced = ", ".join(f'"{name}"' for name in list(scene.geometry)[:8])
        message = (
            f"{path.name}: places none of its bodies, {unplaced}; save it with one in its build"
            if any(len(getattr(mesh, "faces", ())) for mesh in scene.geometry.values())
            else f"{path.name}: has no faces that can be read as {ending[1:].upper()}; a closed mesh is needed"
        )
        raise InputError(message)
    if ending != ".3mf":
        return found, 1.0
    unit = str(scene.units or "millimeter").rstrip("s")
    if unit not in UNITS_3MF:
        message = f'{path.name}: its unit is "{unit[:40]}"; it must be one of {", ".join(UNITS_3MF)}'
        raise InputError(message)
    return found, UNITS_3MF[unit]


def _obj_scene(file: Any) -> Any:
    """Scene of an OBJ file, whose bodies are its objects; where it names none, its groups, if all of them are closed."""
    import trimesh

    def loaded(**split: Any) -> Any:
        file.seek(0)
        return trimesh.load_scene(file, file_type="obj", process=False, **OBJ, **split)

    heads = {line[:2] for line in file.read().splitlines()}
    if b"o " not in heads and b"g " in heads:
        scene = loaded(split_groups=True)
        if len(scene.geometry) > 1 and all(_is_closed(mesh) for mesh in scene.geometry.values()):
            return scene
    return loaded(split_objects=True)


def _is_closed(mesh: Any) -> bool:
    """True where every edge of a mesh is that of an even number of faces, once corners at one place are one."""
    corners = np.unique(np.asarray(mesh.vertices), axis=0, return_inverse=True)[1].ravel()
    faces = corners[np.asarray(mesh.faces)]
    edges = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return bool((np.unique(edges, axis=0, return_counts=True)[1] % 2 == 0).all())


def _closed(name: str, vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> tuple[Surface, list[str]]:
    """Merge corners, drop faces without area, close tiny holes, turn the surface outward; refuse what is left open."""
    import trimesh

    if not np.isfinite(vertices).all():
        message = f"{name}: has coordinates that are no numbers; save it again"
        raise InputError(message)
    if len(faces) and not (faces.min() >= 0 and faces.max() < len(vertices)):
        message = f"{name}: has faces with corners that are not there, of {len(vertices)}; save it again"
        raise InputError(message)
    if len(faces) > MAX_FACES:
        message = f"{name}: has {len(faces)} faces; at most {MAX_FACES} are worked with, so make it coarser"
        raise InputError(message)
    size = float(np.ptp(vertices[np.unique(faces)], axis=0).max()) if len(faces) else 0.0
    if not 1e-6 < size < 1e9:
        message = f"{name}: is {size:.3g} mm large; it must be between 1e-6 and 1e9 mm"
        raise InputError(message)
    notes = []
    keys = np.round(vertices / (MERGED * size)).astype(np.int64)
    _, first, merged = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    faces, vertices = merged.ravel()[faces], vertices[first]
    a, b, c = faces.T
    whole = faces[(a != b) & (b != c) & (c != a)]
    kept, folded_faces = _once(whole)
    folded = len(folded_faces)
    if _width(vertices[folded_faces]) > SLIVER * size:
        notes.append(f"{name}: {2 * folded} faces lie on each other and enclose nothing; they are left out")
    if len(kept) + 2 * folded < len(whole):
        notes.append(f"{name}: {len(whole) - len(kept) - 2 * folded} faces were there twice; each is taken once")
    mesh = trimesh.Trimesh(vertices, kept, process=False)
    alone = trimesh.grouping.group_rows(mesh.edges_sorted, require_count=1)
    open_edges = len(alone)
    if open_edges:
        closed = open_edges <= max(4, OPEN_SHARE * len(mesh.edges_unique)) and mesh.fill_holes()
        if not closed:
            x, y, z = vertices[mesh.edges_sorted[alone[0]]].mean(axis=0).tolist()
            message = (
                f"{name}: is not closed: {open_edges} edges belong to one face only, one at ({x:.4g}, {y:.4g}, {z:.4g}); "
                "close the mesh"
            )
            raise InputError(message)
        notes.append(f"{name}: holes with {open_edges} open edges were closed")
    if not mesh.is_winding_consistent:
        trimesh.repair.fix_winding(mesh)
        notes.append(f"{name}: faces looked different ways; they all look outward now")
    if mesh.is_watertight and volume_of(Surface(mesh.vertices, mesh.faces)) < 0:
        mesh.invert()
        notes.append(f"{name}: all faces looked inward; they look outward now")
    surface = Surface(np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces, dtype=np.int64))
    solid = solid_of(surface)
    if not is_sound(solid) or solid.volume() <= 1e-12 * size**3:
        message = f"{name}: does not enclose a volume: its surface crosses itself or is folded; mend the mesh"
        raise InputError(message)
    if not is_solid_of(solid, surface):
        if not lacks_slits_only(solid, surface):
            message = f"{name}: has walls without thickness, which would be lost; draw them thicker or leave them out"
            raise InputError(message)
        notes.append(f"{name}: has slits without thickness inside it; they are left out")
    whole_solid, said = _united(name, solid)
    return surface_of(whole_solid), notes + said


def _width(triangles: NDArray[np.float64]) -> float:
    """Least height of that triangle (k, 3, 3) [mm] which is the widest; 0 of none."""
    sides = np.roll(triangles, -1, axis=1) - triangles
    twice = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    return float((twice / np.linalg.norm(sides, axis=2).max(axis=1)).max(initial=0.0))


def _once(faces: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Faces that are there several times taken once, and of pairs that look opposite ways and were taken out one each.

    Where merged corners fold a sliver flat, its two sides lie on each other and enclose nothing. Such pairs that hang together go where
    the surface is closed without them; where it is not, they are a side of it that was written both ways.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not len(faces):
        return faces, faces
    ring, first, which = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_inverse=True)
    lowest = np.argmin(faces, axis=1)
    forward = np.take_along_axis(faces, (lowest[:, None] + 1) % 3, axis=1)[:, 0] == ring[which.ravel(), 1]
    count = np.bincount(which.ravel(), minlength=len(ring))
    folded = 2 * np.bincount(which.ravel(), weights=forward, minlength=len(ring)) == count
    _, edge = np.unique(ring[:, [[0, 1], [1, 2], [0, 2]]].reshape(-1, 2), axis=0, return_inverse=True)
    edges = edge.reshape(-1, 3)
    among = np.flatnonzero(folded)
    joins = coo_array(
        (np.ones(3 * len(among)), (np.repeat(among, 3), edges[among].ravel())), (len(ring), edge.max() + 1)
    )
    group = connected_components(joins @ joins.T, directed=False)[1]
    odd = np.bincount(edges.ravel()) % 2 == 1
    out = np.zeros(len(ring), dtype=bool)
    for own in np.unique(group[among]):
        mine = among[group[among] == own]
        rim = np.bincount(edges[mine].ravel(), minlength=len(odd)) % 2 == 1
        out[mine] = 2 * odd[rim].sum() > rim.sum()
    return faces[np.sort(first[~out])], faces[first[out]]


def _united(name: str, solid: Any) -> tuple[Any, list[str]]:
    """One solid of closed surfaces that overlap or share faces, and notes about it; unchanged where they do neither.

    Raises
    ------
    InputError
        If a surface that looks inward does not lie inside one that looks outward, or meets another such.
    """
    shells = solid.decompose()
    if len(shells) < 2:
        return solid, []
    outer = sorted((shell for shell in shells if shell.volume() > 0), key=lambda shell: float(shell.volume()))
    hollows = [turned_over(shell) for shell in shells if shell.volume() <= 0]
    inside: list[list[Any]] = [[] for _ in outer]
    for hollow in hollows:
        owner = next((k for k, one in enumerate(outer) if _same_volume((one ^ hollow).volume(), hollow.volume())), None)
        if owner is not None:  # the smallest, for those inside it have hollows of their own
            inside[owner].append(hollow)
    notes = []
    bodies = [one - union_of(own) if own else one for one, own in zip(outer, inside, strict=True)]
    for body, one, own in zip(bodies, outer, inside, strict=True):
        area = sum(shell.surface_area() for shell in (one, *own))
        if own and abs(body.surface_area() - area) > SAME_SOLID * area:
            notes.append(f"{name}: a hollow reaches the surface or another one: walls without thickness are left out")
    if not _same_volume(sum(body.volume() for body in bodies), solid.volume()):
        message = f"{name}: a surface that looks inward is not round a hollow: it lies outside or crosses another; mend the mesh"
        raise InputError(message)
    whole = union_of(bodies)
    left = len(connected_solids(whole))
    same = _same_volume(whole.volume(), solid.volume()) and len(whole.decompose()) == len(shells)
    if not same:
        notes.append(f"{name}: {len(shells)} closed surfaces overlap or touch; the part is their union")
    if left > 1:
        notes.append(f'{name}: has {left} pieces that share no face; name one as "{name}#1", or {AS_ONE}')
    return (solid if same else whole), notes


def _same_volume(one: float, other: float) -> bool:
    return abs(one - other) <= SAME_VOLUME * abs(other)
