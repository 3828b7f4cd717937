"""`wiggleroom completion`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from cyclopts import App


def completion_of(app: App) -> Callable[..., int]:
    """The command that makes the Tab key know the commands of a program."""

    def completion(shell: Literal["bash", "zsh", "fish"], /) -> int:
        """Print what makes the Tab key complete commands, options and files in your shell.

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
