"""Read STEP files by the library Open CASCADE: bodies by name, planar faces to the last digit, curved ones as triangles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import InputError, require_extra

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SAGITTA = 1 / 4000
"""Triangles lie no further from curved faces than this share of the body's size."""
ANGLE = 0.15
"""Neighbouring triangles of a curved face turn by no more [rad]: 42 to a circle."""


def step_bodies(path: Path) -> dict[str, tuple[Floats, Ints, float]]:
    """Bodies of a STEP file by name: corners (v, 3) [mm], triangles (f, 3), and how far these lie from curved faces [mm], 0 where none is.

    Raises
    ------
    MissingExtraError
        If the library is not installed.
    InputError
        If the file cannot be read, or has no solid in it.
    """
    require_extra("step", f"{path.name}: STEP files need the library Open CASCADE", "OCP")
    found: dict[str, tuple[Floats, Ints, float]] = {}
    for name, solid in _solids(path):
        label = name or "body"
        while label in found:
            label = f"{label}'"
        body = _triangles(solid)
        if len(body[1]):
            found[label] = body
    if not found:
        message = f"{path.name}: has no solid; save the bodies as solids, not as surfaces"
        raise InputError(message)
    return found


def _solids(path: Path) -> list[tuple[str, Any]]:
    """Name and solid of every body, placed as the file places it; lengths in mm."""
    from OCP.collections import Sequence_TDF_Label
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.Message import Message
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopLoc import TopLoc_Location
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):
        messenger.RemovePrinter(printer)  # it would write on the terminal
    document = TDocStd_Document(TCollection_ExtendedString("step"))
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    read = reader.ReadFile(str(path)) == IFSelect_RetDone
    if not (read and reader.Transfer(document)):
        message = f"{path.name}: cannot be read as STEP; save it again"
        raise InputError(message)
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    free = Sequence_TDF_Label()
    tool.GetFreeShapes(free)
    found: list[tuple[str, Any]] = []
    for k in range(1, free.Length() + 1):
        _collect(tool, free.Value(k), TopLoc_Location(), "", found)
    return found


def _collect(tool: Any, label: Any, location: Any, given: str, found: list[tuple[str, Any]]) -> None:
    """Add all solids below a label; an instance keeps its own name where it has one."""
    from OCP.collections import Sequence_TDF_Label
    from OCP.TDF import TDF_Label
    from OCP.TopAbs import TopAbs_SOLID
    from OCP.TopExp import TopExp_Explorer

    if tool.IsReference_s(label):
        target = TDF_Label()
        tool.GetReferredShape_s(label, target)
        own = _name(target) if tool.IsSimpleShape_s(target) else ""
        _collect(tool, target, location.Multiplied(tool.GetLocation_s(label)), own or _name(label), found)
    elif tool.IsAssembly_s(label):
        parts = Sequence_TDF_Label()
        tool.GetComponents_s(label, parts)
        for k in range(1, parts.Length() + 1):
            _collect(tool, parts.Value(k), location, "", found)
    else:
        explorer = TopExp_Explorer(tool.GetShape_s(label).Moved(location), TopAbs_SOLID)
        while explorer.More():
            found.append((given or _name(label), explorer.Current()))
            explorer.Next()


def _name(label: Any) -> str:
    from OCP.TDataStd import TDataStd_Name

    name = TDataStd_Name()
    return str(name.Get().ToExtString()) if label.FindAttribute(TDataStd_Name.GetID_s(), name) else ""


def _triangles(solid: Any) -> tuple[Floats, Ints, float]:
    """Corners, outward triangles, and how far these lie from curved faces at most [mm]; 0 where all faces are flat."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.GeomAbs import GeomAbs_Plane
    from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    box = Bnd_Box()
    BRepBndLib.Add_s(solid, box)
    sagitta = SAGITTA * float(np.sqrt(box.SquareExtent()))
    BRepMesh_IncrementalMesh(solid, sagitta, False, ANGLE, False)
    corners: list[Floats] = []
    triangles: list[Ints] = []
    count, curved = 0, False
    explorer = TopExp_Explorer(solid, TopAbs_FACE)
    while explorer.More():
        face = TopoDS.Face(explorer.Current())
        explorer.Next()
        curved |= BRepAdaptor_Surface(face).GetType() != GeomAbs_Plane
        where = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(face, where)
        if mesh is None:
            continue
        moved = where.Transformation()
        points = [mesh.Node(i).Transformed(moved) for i in range(1, mesh.NbNodes() + 1)]
        corners.append(np.array([(p.X(), p.Y(), p.Z()) for p in points]))
        some = np.array([mesh.Triangle(i).Get() for i in range(1, mesh.NbTriangles() + 1)], dtype=np.int64)[:, -3:]
        triangles.append((some[:, ::-1] if face.Orientation() == TopAbs_REVERSED else some) - 1 + count)
        count += len(points)
    if not triangles:
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64), 0.0
    return np.vstack(corners), np.vstack(triangles), sagitta if curved else 0.0
