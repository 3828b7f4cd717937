"""A process that works off tasks: pickled tasks on stdin, pickled results on stdout, until stdin ends."""

from __future__ import annotations

import os
import pickle
import sys
from typing import BinaryIO


def main(source: BinaryIO, target: BinaryIO) -> None:
    """Read the work and what its tasks share, then answer every task with (True, result) or (False, error)."""
    work, shared = pickle.load(source)
    while True:
        try:
            task = pickle.load(source)
        except EOFError:
            return
        try:
            reply = True, work(shared, task)
        except Exception as problem:
            reply = False, problem
        target.write(pickle.dumps(reply))
        target.flush()


if __name__ == "__main__":
    with os.fdopen(os.dup(1), "wb") as results:
        os.dup2(2, 1)  # whatever a library prints must not end up among the results
        main(sys.stdin.buffer, results)
