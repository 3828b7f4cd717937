"""Findings into files: pictures, pages, models and films, by the ending of the name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from wiggleroom.files import write_whole
from wiggleroom.report.finding import Finding
from wiggleroom.report.pictures.file_endings import PAGE, SPATIAL_STUDIES, STUDIES, check_ending, ending
from wiggleroom.search.answer import Answer


def write_finding(
    finding: Finding, path: Path, command: str = "", progress: Callable[[int, int], None] | None = None
) -> None:
    """Write a picture (.svg, .png) or a page (.html); in space of coloured parts a model too (.glb).

    What shows a motion alone is drawn as that motion, with films. Each kind of file imports what it needs: pages need much.

    Raises
    ------
    InputError
        If the name has another ending, or there is nothing to show.
    """
    motion, solid = finding.motion, finding.figure is None and finding.assembly.dimension == 3
    if motion is not None and finding.figure is None and finding.tints is None:
        from wiggleroom.report.write_picture import write_picture

        write_picture(motion, path, command=command, progress=progress)
        return
    check_ending(path, SPATIAL_STUDIES if solid else STUDIES)
    if ending(path) == PAGE:
        from wiggleroom.report.page.finding_page import page_of_finding

        write_whole(path, page_of_finding(finding, command=command))
    elif solid and isinstance(motion, Answer):
        from wiggleroom.report.page.finding_page import solid_colours
        from wiggleroom.report.pictures.finding_picture import subtitle
        from wiggleroom.report.solids.spatial_picture import write_moved_parts

        lines = [finding.title, ", ".join(subtitle(finding))]
        write_moved_parts(motion.assembly, motion.motion, path, lines, motion.contacts, solid_colours(finding))
    else:
        from wiggleroom.report.pictures.finding_picture import picture_of_finding
        from wiggleroom.report.pictures.stills import write_still

        write_still(picture_of_finding(finding, command=command), path)
