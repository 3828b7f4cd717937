"""The gallery's commands once more, each into a page that can be used: `python -m docs_site.live_pages FOLDER`.

`tests/test_examples.py` asks nearly all of them too, and keeps its pages in the folder that `LIVE_PAGES` names.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import shutil
import sys
import tempfile
from pathlib import Path

from benchmarks.redraw import PICTURES, TOP

from wiggleroom.cli import main as wiggleroom

SKIPPED = ("15_grid", "14_shelf_0", "14_shelf_1", "05_panels_100", "pyjigsaw_10x10")
"""Large, or nearly the same as another."""
KINDS = ("flex", "check", "rank", "tighten", "sweep", "sample")
"""Commands that make pages."""
PICTURE = re.compile(r"^!\[[^\]]*\]\(pictures/([\w.-]+)\)$", re.MULTILINE)
"""A picture in the gallery."""


def commands() -> dict[str, list[str]]:
    """Commands of the pictures in the gallery that a page can show, by the name of the picture."""
    shown = {name.split(".")[0] for name in PICTURE.findall((TOP / "docs" / "gallery.md").read_text(encoding="utf-8"))}
    found = {}
    for line in (PICTURES / "commands.txt").read_text(encoding="utf-8").splitlines():
        words = shlex.split(line, comments=True)
        if words[:1] == ["wiggleroom"] and words[1] in KINDS and "--picture" in words:
            name = Path(words[-1]).name.split(".")[0]
            if name in shown and name not in SKIPPED:
                found[name] = words
    return found


def main() -> int:
    """Make those that are not there."""
    folder = Path(sys.argv[1]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as place:
        os.chdir(place)
        Path("examples").symlink_to(TOP / "examples")
        Path("out").mkdir()
        for name, words in commands().items():
            page = Path("out", f"{name}.html")
            if (folder / page.name).exists():
                continue
            sys.argv = [*words[:-1], str(page)]
            with contextlib.redirect_stdout(io.StringIO()):
                code = wiggleroom()
            if page.exists():
                shutil.move(page, folder)
            else:
                print(f"{shlex.join(words)}: no page, exit code {code}", file=sys.stderr)
                return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
