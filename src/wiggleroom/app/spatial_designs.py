"""From an assembly in space that is open and a design to the assembly as it is made; the same is kept for the next request."""

from __future__ import annotations

import json
from collections.abc import Hashable
from dataclasses import replace
from typing import Any

import numpy as np

from wiggleroom.app.design_cache import DesignedDrawing, LruCache, joint_gaps
from wiggleroom.app.open_requests import File
from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.statements import statement_findings
from wiggleroom.disassembly.ground import drawn_sizes
from wiggleroom.drawing.model import Drawing
from wiggleroom.drawing.units import UNITS
from wiggleroom.errors import InputError
from wiggleroom.report.page.page_messages import design_message
from wiggleroom.report.page.spatial_messages import spatial_opened
from wiggleroom.schema.replies import Opened
from wiggleroom.schema.requests import Design, GoalEntry
from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial, assembly_of

MAX_SHAPES, MAX_ROLES = 6, 6
"""Number of designs whose solids are kept, and of assemblies of them with roles."""


class SpatialDesignCache(DesignedDrawing):
    """Assemblies of one drawing in space.

    Parameters
    ----------
    drawing : Drawing
    """

    def __init__(self, drawing: Drawing) -> None:
        super().__init__(drawing)
        self._made: LruCache[Assembly] = LruCache(MAX_SHAPES)
        self._assemblies: LruCache[Assembly] = LruCache(MAX_ROLES)

    def shape(self, design: Design) -> Hashable:
        """What the solids as shown depend on: glue keeps them together in an exploded view."""
        return self._made_by(design), tuple(map(tuple, design.glue))

    def body(self, design: Design) -> Hashable:
        """What all but the question depends on."""
        return self.shape(design), tuple(sorted(design.fixed))

    def drawing(self, design: Design) -> Drawing:
        """The drawing with the roles of a design.

        Raises
        ------
        InputError
            If the design names parts that are not there, or asks what makes no sense.
        """
        used = super().drawing(design)
        wrong = statement_findings(used)
        if wrong:
            raise InputError(wrong)
        return used

    def assembly(self, design: Design) -> Assembly:
        """Parts as made for a design, without its question: the same object for the same bodies.

        Raises
        ------
        InputError
            With everything that is wrong, one line each.
        """
        used = replace(self.drawing(design), goals=())
        inward = {name: extra / 2 for name, extra in design.extra.items()}
        made = self._made.get(self._made_by(design), lambda: assemble_spatial(used, inward=inward))
        return self._assemblies.get(self.body(design), lambda: assembly_of(used, made.solids))

    def _made_by(self, design: Design) -> Hashable:
        """What the solids as made depend on."""
        return self.gap(design), tuple(sorted(design.extra.items())), joint_gaps(design, ())


def spatial_opened_reply(file: File, designs: SpatialDesignCache, design: Design | None) -> Opened:
    """Reply to `open`: solids as they are made, or as drawn where that cannot be, and what is asked, as a design."""
    asked = design or design_message(file.drawing)
    drawing = designs.drawing(asked)
    try:
        assembly = designs.assembly(asked)
    except InputError:
        assembly = assemble_spatial(replace(drawing, goals=()), gap=0.0)
    reply = spatial_opened(drawing, assembly, file.name)
    if not drawing.goals and len(drawing.parts) > 1:
        reply.pulled = suggested_pull(assembly)
    return reply


def suggested_pull(assembly: Assembly) -> GoalEntry:
    """A pull for an assembly that asks for none: the part farthest from what is fixed, away along an axis that no lock takes."""
    at = assembly.reference
    fixed = np.array([p.fixed for p in assembly.parts])
    if not fixed.any():
        fixed[int(drawn_sizes(assembly).argmax())] = True
    away = at - at[fixed].mean(axis=0)
    k = int(np.where(fixed, -1.0, np.linalg.norm(away, axis=1)).argmax())
    locked = [axis in assembly.parts[k].lock for axis in "xyz"]
    along = int(np.where(locked, -1.0, np.abs(away[k])).argmax())
    direction = [0.0, 0.0, 0.0]
    direction[along] = 1.0 if away[k, along] >= 0 else -1.0
    return GoalEntry(assembly.parts[k].name, direction=tuple(direction))


def designed_file(text: str, drawing: Drawing, design: Design) -> str:
    """The text of a file of format wiggleroom/2 with the gap, the roles and the question of a design, and the drawing's ignored pairs.

    Raises
    ------
    InputError
        If the design says what such a file cannot.
    """
    if design.extra:
        raise InputError(
            "assembly file: extra gaps of single parts cannot be written in space; set them to 0, or draw the parts so"
        )
    if design.goals == "weight":
        raise InputError("assembly file: it cannot ask how parts sink; pull a part, or give --weight -z to the command")
    content: dict[str, Any] = json.loads(text)
    mm = UNITS.get(content.get("unit", "mm"), 1.0)
    if design.gap is not None:
        content["gap"] = design.gap / mm
    for part in content["parts"]:
        part["fixed"] = part["name"] in design.fixed
        if not part["fixed"]:
            del part["fixed"]
    content["glue"] = design.glue
    content["ignore"] = [list(pair) for pair in drawing.ignore]
    gaps = joint_gaps(design, drawing.gaps)
    content["gaps"] = [{"parts": list(joint.parts), "gap": joint.gap / mm} for joint in gaps]
    content["pull"] = [_entry(goal, mm) for goal in design.goals if isinstance(goal, GoalEntry)]
    for key in ("glue", "ignore", "gaps", "pull"):
        if not content[key]:
            del content[key]
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _entry(goal: GoalEntry, mm: float) -> dict[str, Any]:
    """One entry of `pull`."""
    found: dict[str, Any] = {"part": goal.part}
    if goal.direction is not None:
        found["direction"] = list(goal.direction)
    if goal.point is not None:
        found["point"] = [x / mm for x in goal.point]
    if goal.turn is not None:
        found["turn"] = list(goal.turn)
    return found if goal.weight == 1 else found | {"weight": goal.weight}
