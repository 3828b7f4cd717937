"""`wiggleroom completion`."""

from __future__ import annotations

import sys
from typing import Literal


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
    from wiggleroom.cli.app import build

    sys.stdout.write(build().generate_completion(shell=shell))
    return 0
