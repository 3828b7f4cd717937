"""Draw the pictures of docs/pictures anew: `python -m benchmarks.redraw [--check] [NAME ...]`.

The commands stand in docs/pictures/commands.txt. They are run in a folder of their own with the examples beside it, so that what a
picture says of its making is the same everywhere. Nothing is drawn at random, so the bytes are the same too: with --check they
are compared with the committed ones, and those that differ are named. The tables of `wiggleroom bench` measure times on this
machine; they are drawn only by name.
"""

from __future__ import annotations

import argparse
import os
import runpy
import shlex
import sys
import tempfile
from pathlib import Path

from wiggleroom.cli import main as wiggleroom

TOP = Path(__file__).parents[1]
PICTURES = TOP / "docs" / "pictures"
MEASURED = "wiggleroom bench"


def commands(names: list[str]) -> list[list[str]]:
    """Commands that make the named pictures, by default all that measure no time, and what these need."""
    lines = [
        shlex.split(line) for line in (PICTURES / "commands.txt").read_text().splitlines() if not line.startswith("#")
    ]
    drawn = [line for line in lines if line[-1].startswith("docs/pictures/")]
    wanted = [
        line for line in drawn if (Path(line[-1]).name in names if names else not shlex.join(line).startswith(MEASURED))
    ]
    needed = {word for line in wanted for word in line}
    return [line for line in lines if line in wanted or (line not in drawn and line[-1] in needed)]


def run(line: list[str]) -> None:
    """Run a command as the shell would."""
    if line[:2] == ["python", "-m"]:
        sys.argv = line[2:]
        runpy.run_module(line[2], run_name="__main__")
        return
    sys.argv = line
    if wiggleroom() not in (0, 1):
        message = f"{shlex.join(line)}: no picture"
        raise SystemExit(message)


def redraw(names: list[str], folder: Path) -> list[str]:
    """Draw in a folder; names of the pictures that differ from the committed ones."""
    for part in ("examples", "benchmarks", "tests"):
        (folder / part).symlink_to(TOP / part)
    (folder / "out").mkdir()
    (folder / "docs" / "pictures").mkdir(parents=True)
    os.chdir(folder)
    for line in commands(names):
        run(line)
    made = sorted((folder / "docs" / "pictures").iterdir())
    return [
        f.name for f in made if not (PICTURES / f.name).exists() or f.read_bytes() != (PICTURES / f.name).read_bytes()
    ]


def main() -> int:
    """Draw, and put the pictures in their place or say which differ."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="only these, such as blame.svg")
    parser.add_argument(
        "--check", action="store_true", help="change nothing; exit 1 where a committed picture is not what is drawn"
    )
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        other = redraw(asked.names, folder)
        if not asked.check:
            for name in other:
                (PICTURES / name).write_bytes((folder / "docs" / "pictures" / name).read_bytes())
        os.chdir(TOP)
    for name in other:
        sys.stderr.write(f"{name} {'differs from what is drawn' if asked.check else 'drawn anew'}\n")
    return int(asked.check and bool(other))


if __name__ == "__main__":
    sys.exit(main())
