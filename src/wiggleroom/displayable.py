"""What shows itself in a notebook: assemblies, answers and studies."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar


class Displayable:
    """Something that Jupyter shows as a page that can be used, and other places as a few lines of text."""

    mime_bundle: ClassVar[Callable[[Any], dict[str, str]]]
    """Makes what is shown, by media type. The package's root sets it: reports stand to the right of everything shown."""

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:  # noqa: ARG002
        """What IPython asks for; it chooses among the media types itself."""
        return type(self).mime_bundle(self)
