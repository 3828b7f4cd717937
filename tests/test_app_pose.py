"""Poses, ways to read a file again and how far was searched, over the socket."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from tests.app_client import Visit
from tests.browser_page import PEG
from tests.test_page_pose import LATCH

SVG = b"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 40 40"><g fill="none" stroke="black">
<path id="frame" d="M0 0h40v40h-40z M10 10v20h20v-20z"/><path id="peg" d="M12 12h16v16h-16z"/></g></svg>"""


def test_a_pose_is_judged_and_a_drag_begins_there(page: Visit) -> None:
    page.open("latch.json", json.dumps(LATCH).encode())
    assert page.ask("pose", pose={"latch": [0, 12, 0]})["free"]
    refused = page.ask("pose", pose={"slider": [30, 0, 0]})
    assert not refused["free"]
    assert "overlap" in refused["words"]
    grip: dict[str, Any] = {"part": "slider", "grip": [20, 15], "target": [50, 15]}
    held = page.ask("drag", **grip, **{"from": "rest"})
    assert held["distance"] > 29
    free = page.ask("drag", **grip, **{"from": "pose", "pose": {"latch": [0, 12, 0]}})
    assert free["distance"] < 0.01
    pinned = page.ask("drag", **grip, **{"from": "rest", "pinned": ["latch"]})
    assert (pinned["motions"][0][0, 4] == 0).all()
    for wrong, words in (({"bolt": [0, 0, 0]}, "bolt"), ({"latch": [0, 0, 0, 1]}, "4 numbers; 3 are wanted")):
        assert words in page.ask("pose", pose=wrong)["findings"][0]


def test_in_space_a_pose_has_quaternions(page: Visit) -> None:
    parts = [
        {"name": "floor", "boxes": [[0, 0, 0, 9, 9, 1]], "fixed": True},
        {"name": "block", "boxes": [[0, 0, 0, 2, 2, 2]], "at": [4, 4, 1.5]},
    ]
    page.open("block.json", json.dumps({"format": "wiggleroom/2", "parts": parts}).encode())
    half = float(np.sqrt(0.5))
    turned = [0.0, 0.0, 3.0, 0.0, 0.0, half, half]  # a quarter about z
    assert page.ask("pose", pose={"block": turned})["free"]
    assert not page.ask("pose", pose={"block": [0, 0, -1, 0, 0, 0, 1]})["free"]
    told = page.ask(
        "drag", part="block", grip=[5, 5, 2.5], target=[5, 5, 8.5], **{"from": "pose", "pose": {"block": turned}}
    )
    assert told["distance"] == pytest.approx(0, abs=1e-3)
    assert told["motions"][0][0, 1, 5:] == pytest.approx([half, half], abs=1e-6)  # it is turned still


def test_an_answer_says_whether_the_search_has_ended(page: Visit) -> None:
    page.open("peg.json", json.dumps(PEG).encode())
    first = page.ask("flex")
    assert first["search"] == "to come"
    assert first["facts"][0] == "found so far"
    page.ask("bound")
    after = page.ask("flex")
    assert after["search"] == "done"
    assert "found so far" not in after["facts"]


def test_the_open_file_is_read_again_in_another_way(page: Visit) -> None:
    first = page.open("plain.svg", SVG)
    assert first["reading"]["unit"] is None
    assert first["notes"][0] == "has no physical size; 1 user unit is taken as 1 mm"
    again = page.ask("open", name="plain.svg", again=True, unit="in")
    assert again["reading"]["unit"] == "in"
    assert np.array(again["size"]) == pytest.approx(25.4 * np.array(first["size"]))
    assert not any("--" in note for note in again["notes"])
