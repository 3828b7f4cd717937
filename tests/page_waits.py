"""What tests of pages wait for: machines that run tests are busy, so nothing is read once or after a fixed time where it may come later."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, TypeVar

T = TypeVar("T")

PATIENCE = 180.0
"""Nothing takes longer [s], kernels compiled on a busy machine included."""
FRAMES = 12
"""So many frames without a change are rest; changes from one picture to the next take fewer on a fast machine."""
FADED = """() => document.getAnimations().every((one) =>
    one.playState !== 'running' || one.effect.getComputedTiming().iterations === Infinity)"""
LATER = f"""() => new Promise((done) => {{
    let left = {FRAMES};
    const step = () => (left-- ? requestAnimationFrame(step) : done());
    step(); }})"""


def until(page: Any, true: Callable[[], bool], what: str) -> None:
    """Wait until something is true."""
    end = time.monotonic() + PATIENCE
    while not true():
        assert time.monotonic() < end, what
        page.wait_for_timeout(40)


def settled(page: Any, look: Callable[[], T]) -> T:
    """What is seen when it has come to rest: nothing is worked on, no better answer is looked for, and frames go by without a change."""
    seen: list[T] = []

    def rests() -> bool:
        page.locator(".busy, #answer[data-further=true]").first.wait_for(state="detached", timeout=1000 * PATIENCE)
        page.evaluate(LATER)
        seen.append(look())
        return len(seen) > 1 and seen[-1] == seen[-2]

    until(page, rests, "it goes on changing")
    return seen[-1]


def plays(page: Any) -> None:
    """Wait until the place on the path has gone on for some frames."""
    place, seen = page.get_by_label("place on the path from rest"), set()

    def goes_on() -> bool:
        seen.add(place.input_value())
        return len(seen) > 5

    until(page, goes_on, "it does not play")


def faded(page: Any) -> None:
    """Wait until what fades in is there."""
    page.wait_for_function(FADED, timeout=1000 * PATIENCE)
