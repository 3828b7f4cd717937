"""Findings as pages: a tab of the page that is open, and one HTML file each, of drawings and of assemblies in space."""

from __future__ import annotations

from typing import Any

from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.report.finding import Finding, Panel, PartTints
from wiggleroom.report.page.pages import about_answer, page_of_check
from wiggleroom.report.page.solid_page import page_of_separation, page_of_spatial_study
from wiggleroom.report.page.standalone_page import section, shown_drawing, standalone_page
from wiggleroom.report.pictures.finding_picture import figure_svg, part_colours, subtitle
from wiggleroom.report.pictures.plots import Heading
from wiggleroom.report.results.separability import Checked
from wiggleroom.report.solids.solid_colours import Colour
from wiggleroom.schema.study_replies import Piece, StudyReply, StudyTab, Tints, Title

SURE = "How sure is it"


def sections_of(finding: Finding) -> list[Piece]:
    """Figures, tables and sentences of a finding, each under its heading."""
    found = [
        section(one.title, svg=figure_svg(one.figure, Heading(finding.title, framed=False)))
        if isinstance(one, Panel)
        else section(one.title, one.text, columns=one.heads, rows=one.rows)
        for one in finding.sections
        if isinstance(one, Panel) or one.rows
    ]
    return [*found, section(SURE, terms=finding.sure)] if finding.sure else found


def study_message(finding: Finding, of: str, command: str) -> StudyReply:
    """What the open page shows of a study."""
    return StudyReply(
        of=of,
        said=Title(finding.title, list(finding.facts)),
        study=StudyTab(finding.tab, sections_of(finding)),
        tints=_tints(finding.tints),
        command=command,
        extra=dict(finding.extra),
        gap=finding.gap,
    )


def _tints(tints: PartTints | None) -> Tints:
    return Tints("", {}) if tints is None else Tints(tints.unit, dict(tints.values))


def page_of_finding(finding: Finding, *, command: str = "") -> str:
    """One HTML page: what was found, and the motion that it is about."""
    if finding.assembly.dimension == 3:
        return _page_in_space(finding, command)
    motion = finding.motion
    if isinstance(motion, Interlock):
        return page_of_check(Checked(motion), command=command)
    sections = sections_of(finding)
    if motion is None:
        about: dict[str, Any] = {"opened": shown_drawing(finding.assembly)}
        sections += [section("The same in a terminal", command)] if command else []
    else:
        about = about_answer(motion, command)
    told: dict[str, Any] = about | {
        "said": Title(finding.title, list(subtitle(finding))),
        "tab": "study",
        "study": StudyTab(finding.tab, sections),
    }
    if finding.tints is not None:
        told["tints"] = _tints(finding.tints)
    return standalone_page(finding.title, **told | ({} if finding.page is None else dict(finding.page())))


def _page_in_space(finding: Finding, command: str) -> str:
    motion = finding.motion
    if isinstance(motion, Interlock):
        return page_of_separation(motion, command)
    colours = None if finding.tints is None else solid_colours(finding)
    about = motion or finding.assembly
    return page_of_spatial_study(finding.title, subtitle(finding), sections_of(finding), about, command, colours)


def solid_colours(finding: Finding) -> list[Colour]:
    """Colours of the parts, in their order."""
    assert finding.tints is not None
    fill = part_colours(finding.tints, finding.assembly.names).fill
    return [_rgb(fill[name]) for name in finding.assembly.names]


def _rgb(colour: str) -> Colour:
    """Red, green and blue of "#rrggbb".

    >>> _rgb("#0a10ff")
    (10, 16, 255)
    """
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
