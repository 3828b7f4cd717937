"""Films of paths in space: GIF, MP4, and SVG that plays."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import Context
from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.files import write_whole
from wiggleroom.parallel.parallel_run import run_each
from wiggleroom.planning.plan import Plan
from wiggleroom.report.films.film_frames import as_gif, as_mp4, need_film_library
from wiggleroom.report.films.film_svg import PAUSES
from wiggleroom.report.films.film_timing import ease_in_out
from wiggleroom.report.pictures.file_endings import FILM_SVG, FILMS, check_ending, ending
from wiggleroom.report.pictures.png import png
from wiggleroom.report.results.answer_words import certainty, few, headline, towards
from wiggleroom.report.results.plan_results import plan_title, step_sentence
from wiggleroom.report.results.separability import last_direction
from wiggleroom.report.solids.solid_colours import Colour, moved_surfaces
from wiggleroom.report.solids.spatial_path import IN_SIGHT, along_path
from wiggleroom.report.solids.spatial_picture import HEIGHT, WIDTH, Shown, frame_of, spatial_svg
from wiggleroom.search.answer import Answer

if TYPE_CHECKING:
    from PIL.Image import Image as Picture

Floats = NDArray[np.float64]
Progress = Callable[[int, int], None]

SECONDS = 2.4
"""Time of a path [s]."""
RATES = {".gif": 12.5, ".mp4": 20.0, FILM_SVG: 10.0}
"""Frames a second by the ending of the name."""
PIXELS = 680
"""Width of films of pixels."""


def film_of_spatial(found: Answer | Interlock | Plan, path: Path, *, progress: Progress | None = None) -> None:
    """Write a film of an answer, from rest along its path and back where something holds it, or of all escape paths.

    Raises
    ------
    InputError
        If the name has another ending.
    MissingExtraError
        If the library for this kind of film is not installed.
    """
    check_ending(path, FILMS)
    if isinstance(found, Answer):
        facts = f"{found.verdict}, gap {found.assembly.gap:g} mm, {certainty(found)}"
        lines = [[headline(found), facts]]
        paths, back = [found.waypoints], not found.leaves
    elif isinstance(found, Plan):
        paths, back = [step.path for step in found.steps], False
        paths = paths or [found.path]
        lines = [[plan_title(found), f"{k + 1}. {step_sentence(step)}"] for k, step in enumerate(found.steps)]
        lines = lines or [[plan_title(found)]]
    else:
        title = f"{found.verdict} at gap {found.assembly.gap:g} mm"
        still = [np.zeros((1, len(found.assembly.parts), 6))]
        paths, back = [e.path for e in found.escapes] or still, False
        lines = [
            [title, f"{k + 1}. {few(e.parts)} in {towards(last_direction(found, e))}"]
            for k, e in enumerate(found.escapes)
        ] or [[title]]
    kind = ending(path)
    if kind != FILM_SVG:
        need_film_library(kind)
    assembly, frames = found.assembly, max(2, round(SECONDS * RATES[kind]))
    scenes = [
        (motion, said)
        for waypoints, said in zip(paths, lines, strict=True)
        for motion in along_path(assembly, waypoints, ease_in_out(frames) if len(waypoints) > 1 else np.ones(1))
    ]
    shared = (assembly, _frame(assembly, [m for m, _ in scenes]), None)
    drawn = list(run_each(drawn_frame, (shared, scenes), range(len(scenes)), Context(counted=progress)))
    write_whole(path, _played(drawn, kind, back))


def drawn_frame(shared: tuple[tuple[Assembly, tuple[Floats, Floats], Sequence[Colour] | None], list], k: int) -> str:
    """One frame as an SVG."""
    (assembly, frame, colours), scenes = shared
    motion, lines = scenes[k]
    return spatial_svg(assembly, motion, lines, Shown(colours=colours, frame=frame))


def _frame(assembly: Assembly, motions: Sequence[Floats]) -> tuple[Floats, Floats]:
    """What of the picture's plane is in sight: the parts at all times, as far as they stay near."""
    size, corners = assembly.size, []
    for motion in [*motions[:: max(1, len(motions) // 12)], motions[-1]]:
        near = motion.copy()
        far = np.linalg.norm(near[:, :3], axis=1, keepdims=True)
        near[:, :3] *= np.minimum(1.0, IN_SIGHT * size / np.maximum(far, 1e-300))
        corners += moved_surfaces(assembly, near)
    return frame_of(corners)


def _played(drawn: Sequence[str], kind: str, back: bool) -> str | bytes:
    if kind == FILM_SVG:
        return playing_frames(drawn, RATES[kind], back=back)
    images = [_pixels(svg) for svg in drawn]
    return as_gif(images, None, RATES[kind], back=back) if kind == ".gif" else as_mp4(images, RATES[kind], back=back)


def _pixels(svg: str) -> Picture:
    from PIL import Image

    image = Image.open(io.BytesIO(png(svg, width=PIXELS))).convert("RGB")
    return image.crop((0, 0, image.width - image.width % 2, image.height - image.height % 2))


def playing_frames(drawn: Sequence[str], rate: float, *, back: bool) -> str:
    """Pictures, one shown after the other for ever, without any script."""
    count = len(drawn)
    order = [*range(count), *(range(count - 2, 0, -1) if back else ())]
    last = [PAUSES[0] if k == 0 else PAUSES[1] if k == count - 1 else 1 / rate for k in order]
    ends = np.cumsum(last)
    whole = float(ends[-1])
    out = []
    for k, svg in enumerate(drawn):
        body = svg[svg.index(">") + 1 : svg.rindex("</svg>")]
        turns = [j for j, which in enumerate(order) if which == k]
        times, shown = [0.0], ["none"]
        for j in turns:
            begin = float(ends[j] - last[j]) / whole
            if begin == 0:
                times, shown = [0.0], ["inline"]
            else:
                times.append(begin)
                shown.append("inline")
            if ends[j] < whole:
                times.append(float(ends[j]) / whole)
                shown.append("none")
        timing = f'dur="{whole:.2f}s" repeatCount="indefinite" calcMode="discrete"'
        keys = ";".join(f"{t:.5f}" for t in times)
        out.append(
            f'<g display="{"inline" if k == count - 1 else "none"}"><animate attributeName="display" '
            f'values="{";".join(shown)}" keyTimes="{keys}" {timing}/>{body}</g>'
        )
    size = f'width="{WIDTH:g}" height="{HEIGHT:g}" viewBox="0 0 {WIDTH:g} {HEIGHT:g}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>\n' + "\n".join(out) + "\n</svg>\n"
