"""The gallery: every folder of examples/ with a command must give the answer it promises."""

from __future__ import annotations

import json
import re
import shlex
import sys
from pathlib import Path

import pytest

import wiggleroom as wr
from wiggleroom.cli import main

TOP = Path(__file__).parents[1]
EXAMPLES = sorted(path.parent for path in (TOP / "examples").glob("*/command.txt"))
PAGES = [TOP / "README.md", TOP / "CHANGELOG.md", *sorted((TOP / "docs").glob("*.md"))]
BLOCKS = [
    pytest.param(block, id=f"{page.name}-{k + 1}")
    for page in PAGES
    for k, block in enumerate(re.findall(r"<!-- runs -->\n```python\n(.*?)```", page.read_text(), re.DOTALL))
]
PATTERNS = {
    "02_chain_of_tees/chain.json": "chain 10 --joint tee --gap 0.01",
    "03_chain_of_swallowtails/chain.json": "chain 10 --joint swallowtail --gap 0.01",
    "06_frame/frame.json": "frame 15 15 --joint tee --gap 0.01",
    "07_grid/grid.json": "grid 6 5 --joint tee --gap 0.01",
    "20_elephant/elephant.json": "image examples/pictures/elephant.png --blocks 66 --fix b9-1,b47-1 --pull b49-42:+y",
    "21_butterfly/butterfly.json": "image examples/pictures/butterfly.png --blocks 39 --fix b20-15 "
    "--pull b3-23:-x --pull b37-23:+x",
}
LONG = {"20_elephant", "21_butterfly"}
FOLDERS = [pytest.param(p, id=p.name, marks=[pytest.mark.slow] if p.name in LONG else []) for p in EXAMPLES]


def run(command: str, monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.chdir(TOP)
    monkeypatch.setattr(sys, "argv", shlex.split(command))
    return main()


def test_there_are_examples():
    assert len(EXAMPLES) >= 12


@pytest.mark.parametrize("folder", FOLDERS)
def test_example_gives_what_it_promises(folder, monkeypatch, tmp_path):
    command = (folder / "command.txt").read_text().strip()
    expected = json.loads((folder / "expected.json").read_text())
    out = tmp_path / "answer.json"

    assert run(f"{command} --json {shlex.quote(str(out))}", monkeypatch) == 0

    answer = json.loads(out.read_text())
    assert answer["verdict"] in expected["verdict"]
    assert answer["collision_free"] is True
    assert answer["path"] in expected["path"]
    if expected["objective"] is None:
        assert answer["objective"] is None
        assert answer["leaves"] == expected["leaves"]
    else:
        assert answer["objective"] == pytest.approx(expected["objective"], abs=expected["tolerance"], rel=0)


@pytest.mark.parametrize("folder", EXAMPLES, ids=lambda folder: folder.name)
def test_example_is_in_the_gallery(folder):
    gallery = (TOP / "docs" / "gallery.md").read_text()
    assert (folder / "command.txt").read_text().strip() in gallery
    assert (folder / "README.md").read_text().startswith("# ")


@pytest.mark.parametrize("file", PATTERNS)
def test_made_assemblies_are_what_make_writes(file, monkeypatch, tmp_path):
    out = tmp_path / "made.json"
    assert run(f"wiggleroom make {PATTERNS[file]} -o {shlex.quote(str(out))}", monkeypatch) == 0
    assert out.read_text() == (TOP / "examples" / file).read_text()


@pytest.mark.parametrize("block", BLOCKS)
def test_python_in_the_documentation_runs(block, monkeypatch):
    monkeypatch.chdir(TOP)
    exec(compile(block, "documentation", "exec"), {})


def test_assembly_file_in_the_documentation_is_answered(tmp_path):
    page = (TOP / "docs" / "assembly-file.md").read_text()
    (text,) = re.findall(r"<!-- assembly -->\n```json\n(.*?)```", page, re.DOTALL)
    file = tmp_path / "assembly.json"
    file.write_text(text)
    answer = wr.flex(wr.read(file))
    assert answer.verdict == "optimal"
    assert answer.collision_free


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text()):
        assert (page.parent / link).exists(), link
