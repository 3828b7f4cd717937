"""Program: all commands, each from a file of its own; what is slow to import is imported inside them."""

from __future__ import annotations

from collections.abc import Callable

from cyclopts import App

from wiggleroom.cli.assemble_command import assemble
from wiggleroom.cli.bench_command import bench
from wiggleroom.cli.check_command import check
from wiggleroom.cli.completion import completion_of
from wiggleroom.cli.convert_command import convert
from wiggleroom.cli.coupon_command import coupon
from wiggleroom.cli.draw_command import draw, parts
from wiggleroom.cli.flex_command import flex
from wiggleroom.cli.gap_command import gap
from wiggleroom.cli.make_command import make
from wiggleroom.cli.make_image_command import image
from wiggleroom.cli.plan_command import plan
from wiggleroom.cli.rank_command import rank
from wiggleroom.cli.sample_command import sample
from wiggleroom.cli.serve_command import serve
from wiggleroom.cli.space_command import space
from wiggleroom.cli.sweep_command import sweep
from wiggleroom.cli.tighten_command import tighten
from wiggleroom.cli.tolerances_command import tolerances
from wiggleroom.cli.verify_command import verify

_HELP = """How far loose interlocking parts can move, whether they come apart, and whose gap is to blame.

Say what is fixed and where it is pulled, and get the largest motion as a number and a picture:

  wiggleroom flex puzzle.svg --gap 0.2 --fix p1 --pull p20:+x

wiggleroom COMMAND --help says what a command takes; with --picture most of them draw their answer.

Lengths are in mm, angles in degrees; turns of --at-most and --limit in rad.
Exit codes: 0 answered; 1 check says that it comes apart, or verify that a proof
is not verified; 2 bad input or usage; 3 no verdict.
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
    commands: list[Callable[..., int] | App] = [
        flex, check, plan, gap, rank, tighten, sweep, sample, tolerances, space, serve, draw, parts, convert, assemble, maker, coupon,
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
