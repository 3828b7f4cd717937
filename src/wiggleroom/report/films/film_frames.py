"""Films of pixels: GIF by Pillow, MP4 by PyAV."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

from wiggleroom.context import Context
from wiggleroom.errors import require_extra
from wiggleroom.parallel.parallel_run import run_each
from wiggleroom.report.films.film_svg import PAUSES
from wiggleroom.report.films.scene import Scene
from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.missing_glyphs import missing_glyphs
from wiggleroom.report.pictures.png import png

if TYPE_CHECKING:
    from PIL.Image import Image as Picture

Progress = Callable[[int, int], None]

GIF_SIZE, MP4_SIZE = (680, 640), (840, 760)
"""Widest and tallest film [px]."""


PALETTE_FRAMES = 12
"""The colours of a GIF are those of so many of its frames: parts that leave are not in the last one."""


def gif(made: Scene, rate: float, *, back: bool, progress: Progress | None = None) -> bytes:
    """Scene as a GIF that plays for ever.

    Raises
    ------
    MissingExtraError
        If Pillow is not installed.
    """
    need_film_library(".gif")
    return as_gif(list(_frames(made, GIF_SIZE, progress)), _colours(), rate, back=back)


def as_gif(frames: Sequence[Picture], colours: Sequence[int] | None, rate: float, *, back: bool) -> bytes:
    """Images of one size as a GIF that plays for ever, in these colours, or in those that a dozen of them need."""
    from PIL import Image

    if colours is None:
        some = frames[:: max(1, len(frames) // PALETTE_FRAMES)]
        width, height = some[0].size
        sheet = Image.new("RGB", (width, height * len(some)))
        for k, frame in enumerate(some):
            sheet.paste(frame, (0, k * height))
        table = sheet.quantize(dither=Image.Dither.NONE)
    else:
        table = Image.new("P", (1, 1))
        table.putpalette(list(colours))
    few = [f.quantize(palette=table, dither=Image.Dither.NONE) for f in frames]
    step = round(1000 / rate)
    wait = [step] * len(few)
    wait[0], wait[-1] = (int(1000 * p) for p in PAUSES)
    if back:
        few, wait = [*few, *few[-2:0:-1]], [*wait, *wait[-2:0:-1]]
    file = io.BytesIO()
    few[0].save(file, "GIF", save_all=True, append_images=few[1:], duration=wait, loop=0, optimize=False, disposal=1)
    return file.getvalue()


def mp4(made: Scene, rate: float, *, back: bool, progress: Progress | None = None) -> bytes:
    """Scene as H.264 in an MP4 file that plays in browsers and slides.

    Raises
    ------
    MissingExtraError
        If PyAV or Pillow is not installed.
    """
    need_film_library(".mp4")
    return as_mp4(list(_frames(made, MP4_SIZE, progress)), rate, back=back)


def as_mp4(images: Sequence[Picture], rate: float, *, back: bool) -> bytes:
    """Images of one size with even sides as H.264 in an MP4 file."""
    import av

    frames = [av.VideoFrame.from_image(image) for image in images]
    still = [round(p * rate) for p in PAUSES]
    order = [0] * still[0] + list(range(len(frames))) + [len(frames) - 1] * still[1]
    if back:
        order += list(range(len(frames) - 2, -1, -1))
    file = io.BytesIO()
    with av.open(file, "w", format="mp4") as box:
        stream: Any = box.add_stream("libx264" if "libx264" in av.codecs_available else "mpeg4", rate=round(rate))
        stream.width, stream.height, stream.pix_fmt = frames[0].width, frames[0].height, "yuv420p"
        stream.options = {"crf": "22", "preset": "veryfast", "tune": "animation"}
        for k, which in enumerate(order):
            frame = frames[which]
            frame.pts = k
            box.mux(stream.encode(frame))
        box.mux(stream.encode(None))
    return file.getvalue()


def _frames(made: Scene, room: tuple[int, int], progress: Progress | None) -> Iterator[Picture]:
    """Frames from rest to the end, as RGB images with even sides.

    What stays is drawn once; each frame then draws what moves, and only where it may move; long
    films are drawn by several processes.
    """
    from PIL import Image

    width = 2 * round(min(room[0], room[1] * made.width / made.height) / 2)
    scale = width / made.width
    texts = (made.head, made.defs, *(track.drawn(0) for track in made.tracks))
    own = not missing_glyphs(texts, own_font_only=True)
    still = Image.open(io.BytesIO(png(f"{made.head}</svg>", width=width, own_font_only=own))).convert("RGB")
    still = still.crop((0, 0, width, still.height - still.height % 2))
    x, y, wide, high = (scale * s for s in made.stage)
    left, top = max(math.floor(x), 0), max(math.floor(y), 0)
    box = (left, top, min(math.ceil(x + wide), still.width), min(math.ceil(y + high), still.height))
    for drawn in run_each(moving, (made, box, scale, own), range(made.frames), Context(counted=progress)):
        over = Image.open(io.BytesIO(drawn))
        image = still.copy()
        image.paste(over, box[:2], over)
        yield image


def moving(shared: tuple[Scene, tuple[int, int, int, int], float, bool], k: int) -> bytes:
    """What moves in frame k as a PNG without paper, for the pixels of a box (left, top, right, bottom)."""
    made, box, scale, own_font_only = shared
    wide, high = box[2] - box[0], box[3] - box[1]
    seen = " ".join(f"{v / scale:.4f}" for v in (box[0], box[1], wide, high))
    svg = (
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
        f'width="{wide}" height="{high}" viewBox="{seen}" preserveAspectRatio="none">'
        f"<defs>{made.defs}</defs>{''.join(t.drawn(k) for t in made.tracks)}</svg>"
    )
    return png(svg, width=wide, own_font_only=own_font_only)


def _colours() -> list[int]:
    """Red, green and blue of the colours that films are made of and of the steps between any two of them."""
    thin = [tuple(round(0.85 * c + 0.15 * 255) for c in _rgb(fill)) for fill, _ in palette.ROLE_COLOURS.values()]
    lines = [stroke for _, stroke in palette.ROLE_COLOURS.values()]
    pure = [_rgb(c) for c in (palette.PAPER, palette.INK, palette.SUBDUED, palette.REST, palette.MOTION, *lines)]
    pure += thin
    between = [
        tuple(round((1 - t) * p + t * q) for p, q in zip(one, other, strict=True))
        for one, other in combinations(pure, 2)
        for t in (1 / 3, 2 / 3)
    ]
    return [value for colour in [*pure, *between] for value in colour]


def _rgb(colour: str) -> tuple[int, ...]:
    return tuple(bytes.fromhex(colour[1:]))


def need_film_library(kind: str) -> None:
    """Check that what a film of this kind (.gif or .mp4) needs is installed.

    Raises
    ------
    MissingExtraError
        If it is not.
    """
    require_extra("film", f"a {kind} film needs the extra film; .film.svg and .html need nothing more", *_NEEDS[kind])


_NEEDS = {".gif": ("PIL",), ".mp4": ("PIL", "av")}
