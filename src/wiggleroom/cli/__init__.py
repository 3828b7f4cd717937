"""Command line."""

from __future__ import annotations

import atexit
import gc
import os
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cyclopts import App, CycloptsError

ANSWERED, BAD_INPUT, NO_VERDICT = 0, 2, 3
"""Exit codes; `check` and `verify` have 1 for the answer no."""
COLLECTION_THRESHOLD = 200_000
"""Number of new objects before garbage is collected: a command makes many that stay, and hardly any garbage."""


def main() -> int:
    """Run what `sys.argv` says; the exit code is 0 answered, 2 bad input or usage, 3 no verdict."""
    gc.set_threshold(COLLECTION_THRESHOLD)
    atexit.register(
        gc.freeze
    )  # what is left at the end goes with the process: looking through it takes a quarter of a second
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a name that the terminal cannot show must not end the program
    try:
        code = _run(sys.argv[1:])
        sys.stdout.flush()
    except (BrokenPipeError, SystemExit):  # whoever read our output has seen enough; rich leaves by SystemExit then
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return ANSWERED
    except KeyboardInterrupt:
        _say("interrupted")
        return NO_VERDICT
    except OSError as problem:
        _say(f"{problem.filename or 'stdout'}: {(problem.strerror or str(problem)).lower()}")
        return BAD_INPUT
    return code


def _run(argv: list[str]) -> int:
    """Parse and run; whatever is wrong becomes plain lines on stderr."""
    from cyclopts import CycloptsError

    from wiggleroom.cli.app import build
    from wiggleroom.cli.words import with_json_alone
    from wiggleroom.errors import InputError, StoppedError, UnsureError, WiggleroomError, where_raised

    app = build()
    try:
        return int(app(with_json_alone(argv)) or ANSWERED)
    except CycloptsError as problem:
        _say(_usage(problem, app))
    except InputError as problem:
        for finding in problem.findings:
            _say(finding)
    except UnsureError as problem:
        for finding in problem.findings:
            _say(finding)
        return NO_VERDICT
    except StoppedError as problem:
        _say(str(problem))
        return NO_VERDICT
    except WiggleroomError as problem:
        _say(str(problem))
    except (OSError, KeyboardInterrupt):
        raise
    except Exception as problem:
        _say(
            f"this is a fault in wiggleroom, not in your drawing: {type(problem).__name__}: {problem}{where_raised(problem)}"
        )
        return NO_VERDICT
    return BAD_INPUT


def _usage(problem: CycloptsError, app: App) -> str:
    """Say what is wrong with the command line, in one line, and what may have been meant."""
    from wiggleroom.cli.words import meant

    unused = problem.unused_tokens
    if not unused:
        said = " ".join(str(problem).split())
    elif not problem.command_chain:
        said = f"there is no command {unused[0]}. {meant(unused[0], (c for c in app if c[0] != '-'))}"
    else:
        command = app
        for name in problem.command_chain:
            command = command[name]
        names = [name for argument in command.assemble_argument_collection() for name in argument.names]
        takes = " ".join(name for name in names if name[0] not in "-*")
        odd = next((word.partition("=")[0] for word in unused if word.startswith("-")), "")
        unknown = odd and odd not in names
        wrong = f"{odd} is given no value" if odd else f"unexpected: {' '.join(unused)}"
        if unknown:
            wrong = f"there is no option {odd}"
        said = f"{wrong}; {problem.command_chain[-1]} takes {takes} and options. {meant(odd, names) if unknown else ''}"
    return f"{said.strip().rstrip('.')} (wiggleroom --help says more)"


def _say(line: str) -> None:
    print(" ".join(line.split()), file=sys.stderr)  # noqa: T201
