"""What stands in a registry stands in every other place that names it."""

from __future__ import annotations

import inspect
import pkgutil
import re
import typing
from importlib import import_module
from pathlib import Path

import pytest
from benchmarks.architecture_picture import EVERYWHERE, LANES
from msgspec import Struct

from tests.test_imports import ORDER
from wiggleroom import schema
from wiggleroom.app.dispatcher import ANSWERS, OF_DRAWINGS
from wiggleroom.assembly.joints import JOINTS
from wiggleroom.cli import coupon_command, make_command, make_image_command
from wiggleroom.cli.words import DRAWINGS
from wiggleroom.drawing import dimension
from wiggleroom.drawing.read import READERS
from wiggleroom.schema import replies, requests, results
from wiggleroom.solve import SOLVERS
from wiggleroom.studies.flex import FlexQuestion

TOP = Path(__file__).parents[1]


@pytest.mark.parametrize("command", [make_command.make, make_image_command.image, coupon_command.coupon])
def test_the_help_of_joint_names_every_family(command):
    said = re.search(r"\n    joint\n        ([^\n]*)", inspect.getdoc(command).replace("\n", "\n    "))
    named = set(re.findall(r"\w+", said[1]))
    families = {family: name for name, family in reversed(JOINTS.items())}.values()  # "t" is short for "tee"
    assert set(families) <= named


def test_every_format_that_is_read_is_known_to_the_command_line_and_the_page():
    assert {*DRAWINGS, ".json"} == set(READERS)
    accepted = re.search(r'accept="([^"]*)"', (TOP / "web/src/chrome/TopBar.tsx").read_text())
    assert set(accepted[1].split(",")) == {*READERS, *dimension.PUZZLES}


def test_every_text_that_lists_the_formats_of_drawings_lists_all():
    formats = set(READERS) - {".json", ".lbrn"}  # LightBurn's older ending stands for itself
    texts = {path: path.read_text() for path in (TOP / "src").rglob("*.py")}
    lists = [
        (path.name, found) for path, text in texts.items() for found in re.findall(r"\(((?:\.\w+, )+\.\w+)\)", text)
    ]
    assert len(lists) > 10
    assert [(name, found) for name, found in lists if ".dxf" in found and not formats <= set(found.split(", "))] == []


def structures(module):
    """Structures of a module from which no other is derived."""
    own = [one for one in vars(module).values() if isinstance(one, type) and issubclass(one, Struct)]
    return {one for one in own if one.__module__ == module.__name__ and not one.__subclasses__()}


def all_structures():
    """Structures of all modules that say what results and messages hold."""
    modules = [import_module(f"wiggleroom.schema.{found.name}") for found in pkgutil.iter_modules(schema.__path__)]
    return {one for module in modules for one in structures(module)}


def test_every_format_of_results_is_listed_and_documented():
    formats = {one for one in all_structures() if one.__struct_config__.tag_field == "format"}
    assert formats == set(results.RESULTS)
    page = (TOP / "docs/json.md").read_text()
    assert [one.__name__ for one in formats if f"<!-- generated from {one.__name__} -->" not in page] == []


@pytest.mark.parametrize(
    ("base", "every"), [(requests.Request, requests.AnyRequest), (replies.Reply, replies.AnyReply)]
)
def test_every_message_is_part_of_the_protocol(base, every):
    assert {one for one in all_structures() if issubclass(one, base)} == set(typing.get_args(every))


def test_every_request_is_answered():
    kinds = {kind.__struct_config__.tag for kind in typing.get_args(requests.AnyRequest)}
    assert kinds - {"open", "flex", "cancel"} == set(ANSWERS)


def test_the_page_of_the_protocol_names_every_request_and_what_is_of_drawings_alone():
    page = (TOP / "docs/page-protocol.md").read_text().split("## Requests and replies")[1].split("\n## ")[0]
    table = {
        name for row in page.splitlines() if row.startswith("| `") for name in re.findall(r"`(\w+)`", row.split("|")[1])
    }
    assert table == {kind.__struct_config__.tag for kind in typing.get_args(requests.AnyRequest)}
    assert set(re.findall(r"`(\w+)`", page.split(" are for drawings only")[0].splitlines()[-1])) == set(OF_DRAWINGS)


def test_the_picture_of_the_architecture_shows_every_package():
    assert {*EVERYWHERE, *(name for _, names in LANES for name in names)} == set(ORDER)


def test_every_file_that_the_architecture_names_is_there():
    page = (TOP / "docs/architecture.md").read_text()
    folders = ("", "src/wiggleroom/**", "web/src/**")
    named = re.findall(r"`((?:\w+/)*\w+\.(?:py|tsx?))`", page)
    assert [
        name for name in named if not any(any(TOP.glob(f"{folder}/{name}".lstrip("/"))) for folder in folders)
    ] == []


def test_every_solver_is_a_choice_of_the_command():
    hints = typing.get_type_hints(FlexQuestion)
    assert set(typing.get_args(hints["solver"])) == set(SOLVERS)


def test_every_name_that_the_architecture_gives_with_a_file_is_in_that_file():
    page = (TOP / "docs/architecture.md").read_text().split("## Where to find")[1].split("\n## ")[0]
    rows = [line for line in page.splitlines() if line.startswith("| ")]
    lost = []
    for quoted in (re.findall(r"`([^`]+)`", row) for row in rows):
        source = ""
        for one in quoted:
            if one.endswith(".py"):
                path = TOP / "src/wiggleroom" / one
                source = path.read_text() if path.exists() else ""
            elif re.fullmatch(r"[A-Za-z_]\w*(\.\w+)*", one) and source:
                lost += [f"{one}: {name}" for name in one.split(".") if not re.search(rf"\b{name}\b", source)]
    assert lost == []
