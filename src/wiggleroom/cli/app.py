"""Program: all commands, each from a file of its own; what is slow to import is imported inside them."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Literal

from cyclopts import App

from wiggleroom.cli.assemble_command import assemble
from wiggleroom.cli.bench_command import bench
from wiggleroom.cli.convert_command import convert
from wiggleroom.cli.coupon_command import coupon
from wiggleroom.cli.draw_command import draw, parts
from wiggleroom.cli.make_burr_command import burr
from wiggleroom.cli.make_command import make
from wiggleroom.cli.make_image_command import image
from wiggleroom.cli.serve_command import serve
from wiggleroom.cli.space_command import space
from wiggleroom.cli.study_command import study_command
from wiggleroom.cli.verify_command import verify
from wiggleroom.studies.registry import QUESTIONS

_HELP = """Compute how far loose interlocking parts can move, whether they come apart, and which gap is to blame.

Give the fixed and the pulled part, and get the largest motion as a number and a picture:

  wiggleroom flex puzzle.svg --gap 0.2 --fix p1 --pull p20:+x

wiggleroom COMMAND --help lists the options of a command; most commands draw their answer with --picture.

Lengths are in mm, angles in degrees; turns of --at-most and --limit in rad.
Exit codes: 0 answered; 1 the assembly comes apart (check) or a proof
does not hold (verify); 2 bad input or usage; 3 no verdict.
"""


def build() -> App:
    """Program with all its commands."""
    app = App(
        name="wiggleroom",
        help=_HELP,
        version=_version,
        help_format="plaintext",  # markdown would cost 50 ms here
        exit_on_error=False,
        print_error=False,
        result_action="return_value",
        suppress_keyboard_interrupt=False,
    )
    maker = App(name="make", help_format="markdown")
    maker.default(make)
    maker.command(image)
    maker.command(burr)
    commands: list[Callable[..., int] | App] = [
        *map(study_command, QUESTIONS), space, serve, draw, parts, convert, assemble, maker, coupon,
        verify, bench, completion_of(app),
    ]  # fmt: skip
    for place, command in enumerate(commands):
        if isinstance(command, App):
            command.sort_key = place
            app.command(command)
        else:
            app.command(command, help_format="markdown", sort_key=place)
    return app


def _version() -> str:
    from importlib.metadata import version

    return version("wiggleroom")


def completion_of(app: App) -> Callable[..., int]:
    """The command that makes the Tab key know the commands of a program."""

    def completion(shell: Literal["bash", "zsh", "fish"], /) -> int:
        """Print a script that completes commands, options and files by the Tab key in your shell.

        Example: wiggleroom completion bash > ~/.local/share/bash-completion/completions/wiggleroom

        Example: wiggleroom completion zsh > "${fpath[1]}/_wiggleroom"

        Example: wiggleroom completion fish > ~/.config/fish/completions/wiggleroom.fish

        Parameters
        ----------
        shell
            bash, zsh or fish.
        """
        sys.stdout.write(app.generate_completion(shell=shell))
        return 0

    return completion
