"""What all replies to the page have in common."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from wiggleroom.schema.fields import Ring

Terms = Annotated[list[tuple[str, str]], Meta(description="a word and a sentence each")]
Outline = Annotated[list[Ring], Meta(description="outer outlines and holes of one part, even-odd [mm]")]
Pose = tuple[float, float, float]
Cell = Annotated[
    str | list[str] | float | None, Meta(description="a word, names of parts, or a number; null where it is not known")
]


class Reply(Struct, tag_field="kind", tag=str.lower, kw_only=True):
    """Base of all replies; `id` is that of the request."""

    id: int = 0
