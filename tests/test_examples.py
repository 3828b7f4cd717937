"""The gallery: every folder of examples/ with a command must give the answer it promises."""

from __future__ import annotations

import json
import os
import re
import runpy
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import trimesh
from docs_site import live_pages

import wiggleroom as wr
from wiggleroom.cli import main

TOP = Path(__file__).parents[1]
EXAMPLES = sorted(path.parent for path in (TOP / "examples").glob("*/command.txt"))
PAGES = [TOP / "README.md", TOP / "CHANGELOG.md", *sorted((TOP / "docs").glob("*.md"))]
BLOCKS = {
    f"{page.name}-{k + 1}": block
    for page in PAGES
    for k, block in enumerate(re.findall(r"<!-- runs -->\n```python\n(.*?)```", page.read_text(), re.DOTALL))
}
ADDING = [name for name in BLOCKS if name.startswith("architecture.md")]
"""Blocks that add to the registries: each in a process of its own, so that other tests do not see what they add."""
SHOWN = {
    f"{page.name}-{k + 1}": found
    for page in PAGES
    for k, found in enumerate(
        re.findall(r"```sh\n([^`]*)```(?:(?!```).)*?<!-- prints -->\n```\n(.*?)```", page.read_text(), re.DOTALL)
    )
}
"""Commands in the documentation and what they are said to print; "..." on a line of its own leaves lines out."""
PATTERNS = {
    "02_chain_of_tees/chain.json": "chain 10 --joint tee --gap 0.01",
    "03_chain_of_swallowtails/chain.json": "chain 10 --joint swallowtail --gap 0.01",
    "06_frame/frame.json": "frame 15 15 --joint tee --gap 0.01",
    "07_grid/grid.json": "grid 6 5 --joint tee --gap 0.01",
    "20_elephant/elephant.json": "image examples/pictures/elephant.png --blocks 66 --fix b9-1,b47-1 --pull b49-42:+y",
    "21_butterfly/butterfly.json": "image examples/pictures/butterfly.png --blocks 39 --fix b20-15 "
    "--pull b3-23:-x --pull b37-23:+x",
}

SLOW = (
    "04_jigsaw", "05_panels", "06_frame", "14_shelf", "15_grid", "16_chain_sweeps", "18_grid_of_4096", "19_space_divider", "20_elephant",
    "21_butterfly", "22_fasteners", "23_mechanisms", "41_drawer_in_a_case", "44_six_piece_burr", "46_plans", "50_three_piece_burr",
    "51_hinge",
)  # fmt: skip
LIVE = {shlex.join(words[:-2]): f"{name}.html" for name, words in live_pages.commands().items()}
"""Live pages of the site, by the commands that they show."""
DRAWN = ("14_shelf", "19_space_divider", "23_mechanisms")
"""Examples whose drawings a script writes, draw.py beside them."""


def run(command: str, monkeypatch: pytest.MonkeyPatch, folder: Path = TOP) -> int:
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "argv", shlex.split(command))
    return main()


def promised(folder: Path) -> list[tuple[str, dict]]:
    """Commands of an example, one a line, each with what it must answer: expected.json holds one entry, or a list of them."""
    commands = (folder / "command.txt").read_text().splitlines()
    expected = json.loads((folder / "expected.json").read_text())
    return list(zip(commands, expected if isinstance(expected, list) else [expected], strict=True))


def inside(record: object, path: str) -> object:
    """Value at a path such as "gaps.0.objective"."""
    for key in path.split("."):
        record = record[int(key)] if isinstance(record, list) else record[key]
    return record


@pytest.mark.parametrize(
    "folder", [pytest.param(f, id=f.name, marks=[pytest.mark.slow] if f.name in SLOW else []) for f in EXAMPLES]
)
def test_example_gives_what_it_promises(folder, monkeypatch, tmp_path):
    (tmp_path / "examples").symlink_to(TOP / "examples")
    (tmp_path / "out").mkdir()
    for command, expected in promised(folder):
        if command.startswith("wiggleroom make"):
            assert run(command, monkeypatch, tmp_path) == 0
            continue
        page = LIVE.get(command)
        shown = f"{command} --picture out/{page}" if page else command
        answer = json_of(shown, monkeypatch, tmp_path, expected.get("exit", 0))
        if page:
            keep(tmp_path / "out" / page)
        for path, wanted in expected.get("values", {}).items():
            found = inside(answer, path)
            if isinstance(wanted, list) and isinstance(wanted[0], float):
                assert found == pytest.approx(wanted[0], abs=wanted[1], rel=0), path
            else:
                assert found == wanted, path
        if command.startswith("wiggleroom flex"):
            check_flex(answer, expected)


def keep(page: Path) -> None:
    """A page of a command is there; the site is spared making it again where it is said in which folder it looks for them."""
    assert page.stat().st_size > 10_000
    if folder := os.environ.get("LIVE_PAGES"):
        Path(folder).mkdir(parents=True, exist_ok=True)
        shutil.copy(page, folder)


def json_of(command: str, monkeypatch: pytest.MonkeyPatch, folder: Path, code: int = 0) -> dict:
    """What a command says as JSON."""
    assert run(f"{command} --json out/answer.json", monkeypatch, folder) == code
    return json.loads((folder / "out" / "answer.json").read_text())


def check_flex(answer: dict, expected: dict) -> None:
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
    for command in (folder / "command.txt").read_text().splitlines():
        assert command in gallery
    assert (folder / "README.md").read_text().startswith("# ")


@pytest.mark.parametrize("file", PATTERNS)
def test_made_assemblies_are_what_make_writes(file, monkeypatch, tmp_path):
    out = tmp_path / "made.json"
    assert run(f"wiggleroom make {PATTERNS[file]} -o {shlex.quote(str(out))}", monkeypatch) == 0
    assert out.read_text() == (TOP / "examples" / file).read_text()


@pytest.mark.parametrize("name", DRAWN)
def test_drawings_are_what_their_scripts_write(name, monkeypatch, tmp_path):
    folder = TOP / "examples" / name
    (tmp_path / "draw.py").write_text((folder / "draw.py").read_text())
    runpy.run_path(str(tmp_path / "draw.py"), run_name="__main__")
    drawn = sorted(file for file in tmp_path.iterdir() if file.suffix != ".py")
    known = {"README.md", "command.txt", "draw.py", "expected.json"}
    assert [file.name for file in drawn] == sorted(file.name for file in folder.iterdir() if file.name not in known)
    for file in drawn:
        assert file.read_text() == (folder / file.name).read_text()


@pytest.fixture
def beside_examples(tmp_path, monkeypatch):
    """A folder to work in that has what the documentation reads."""
    for folder in ("examples", "docs"):
        (tmp_path / folder).symlink_to(TOP / folder)
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", [name for name in BLOCKS if name not in ADDING])
def test_python_in_the_documentation_runs(name, beside_examples):
    assert set(re.findall(r"\bwr\.(\w+)", BLOCKS[name])) <= {*wr.__all__}
    exec(compile(BLOCKS[name], name, "exec"), {"__name__": "__main__"})


@pytest.mark.parametrize("name", ADDING)
def test_what_the_documentation_adds_is_taken(name, beside_examples):
    done = subprocess.run([sys.executable, "-c", BLOCKS[name]], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def words(text: str) -> list[str]:
    """Words and numbers, however lines are broken and columns are drawn."""
    return re.findall(r"[^\s─]+", text)


def same(said: str, found: str) -> bool:
    """Whether two words are alike; numbers may differ by some units of the fourth digit, as between machines."""
    try:
        return float(found) == pytest.approx(float(said), rel=5e-4, abs=1e-12)
    except ValueError:
        return said == found


@pytest.mark.parametrize("name", SHOWN)
def test_what_the_documentation_shows_is_printed(name, monkeypatch, tmp_path, capsys):
    (tmp_path / "examples").symlink_to(TOP / "examples")
    (tmp_path / "docs" / "pictures").mkdir(parents=True)
    commands, shown = SHOWN[name]
    for line in commands.splitlines():
        capsys.readouterr()
        run(line.partition(" #")[0], monkeypatch, tmp_path)
    done = capsys.readouterr()
    found, begin = words(done.out + done.err), 0
    for part in re.split(r"^ *\.\.\.$", shown, flags=re.MULTILINE):
        said = words(part)
        places = range(begin, len(found) - len(said) + 1)
        at = next((i for i in places if all(map(same, said, found[i:]))), None)
        assert at is not None, f"{part}\nis not in\n{done.out}{done.err}"
        begin = at + len(said)


def test_assembly_file_in_the_documentation_is_answered(tmp_path):
    page = (TOP / "docs" / "assembly-file.md").read_text()
    (text,) = re.findall(r"<!-- assembly -->\n```json\n(.*?)```", page, re.DOTALL)
    file = tmp_path / "assembly.json"
    file.write_text(text)
    answer = wr.flex(wr.read(file))
    assert answer.verdict in ("proven", "optimal")
    assert answer.collision_free


def test_assembly_file_in_space_in_the_documentation_is_answered(tmp_path):
    page = (TOP / "docs" / "in-space.md").read_text()
    (text,) = re.findall(r"<!-- assembly in space -->\n```json\n(.*?)```", page, re.DOTALL)
    file = tmp_path / "box.json"
    file.write_text(text)
    (tmp_path / "sheet.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="90mm" height="70mm" viewBox="0 0 90 70">'
        '<rect id="lid" width="80" height="60" fill="none" stroke="black"/></svg>'
    )
    trimesh.creation.cylinder(radius=3, height=30, sections=16).export(tmp_path / "pin.stl")
    assert [part.name for part in wr.read(file).parts] == ["bottom", "lid", "pin", "bar"]
    assert wr.flex(wr.read(file), search=0).leaves == ("lid",)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text()):
        assert (page.parent / link).exists(), link
