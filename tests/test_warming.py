"""What nobody has asked yet is made ready while nobody waits, and what compiles ends at once when somebody does."""

from __future__ import annotations

import asyncio
import os
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

import wiggleroom as wr
from tests.app_client import Served
from tests.page_waits import PATIENCE
from tests.test_compiled import ROOT, run
from wiggleroom.app import warming
from wiggleroom.app.warming import Warming
from wiggleroom.drawing.writers.assembly_writer import write_assembly


@pytest.fixture
def endless(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Path, tuple[str, ...]]:
    """A command that notes its process number in a file and does not end; and that file."""
    monkeypatch.setattr(warming, "IDLE_SECONDS", 0.01)
    note = tmp_path / "note"
    code = f"import os, time; open({str(note)!r} + '.new', 'w').write(str(os.getpid())); os.rename({str(note)!r} + '.new', {str(note)!r})"
    return note, (sys.executable, "-c", f"{code}; time.sleep({10 * PATIENCE})")


async def nothing() -> None:
    """Prepare no page."""


def runs(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


async def until(true: Callable[[], bool]) -> None:
    async with asyncio.timeout(PATIENCE):
        while not true():
            await asyncio.sleep(0.01)


async def begun(note: Path) -> int:
    """Process number of what has begun; the note is taken away."""
    await until(note.exists)
    pid = int(note.read_text())
    note.unlink()
    return pid


def test_it_begins_when_all_is_answered_and_ends_when_something_is_asked(endless: tuple[Path, tuple[str, ...]]) -> None:
    note, command = endless

    async def live() -> None:
        one = Warming(nothing, command)
        with one.held():
            with one.held():
                await asyncio.sleep(0.05)
            await asyncio.sleep(0.5)
            assert not note.exists(), "another page still waits"
        first = await begun(note)
        with one.held():
            await until(lambda: not runs(first))
        second = await begun(note)
        await one.close()
        assert not runs(second)
        with one.held():
            pass
        await asyncio.sleep(0.5)
        assert not note.exists(), "it was ended for good"

    asyncio.run(live())


def test_a_server_begins_after_its_first_answer_and_ends_it_when_it_closes(
    endless: tuple[Path, tuple[str, ...]],
) -> None:
    note, command = endless
    served = Served()
    served.page.pool.warming = Warming(nothing, command)
    try:
        with served.visit() as page:
            page.open("chain.json", write_assembly(wr.patterns.chain(2, gap=0.02).drawing).encode())
            page.ask("flex")
            pid = asyncio.run(begun(note))
    finally:
        served.close()
    assert not runs(pid)


def test_a_server_prepares_the_next_page_after_its_first_answer() -> None:
    served = Served()
    pool = served.page.pool
    try:
        with served.visit() as page:
            page.open("chain.json", write_assembly(wr.patterns.chain(2, gap=0.02).drawing).encode())
            page.ask("flex")
            assert pool.spare is None
            asyncio.run(until(lambda: pool.spare is not None))
            assert len(pool.taken) == 1
    finally:
        served.close()


LOADED = """
import sys
from numba.core.dispatcher import Dispatcher
import wiggleroom as wr
from wiggleroom.cli.compile import compile_kernels
from wiggleroom.drawing.model import Pull

def loaded():
    modules = [module for name, module in list(sys.modules.items()) if name.startswith("wiggleroom.")]
    kernels = {one for module in modules for one in vars(module).values() if isinstance(one, Dispatcher)}
    return {f"{k.py_func.__name__}{signature}" for k in kernels if "no_cpython_wrapper" not in k.targetoptions for signature in k.overloads}

compile_kernels()
before = loaded()
jigsaw = wr.patterns.jigsaw(3, 2, gap=0.02)
a, b = jigsaw.names[:2]
answer = wr.flex(jigsaw)
wr.check(jigsaw), wr.free_space(jigsaw, a, b), wr.rank(answer), wr.tighten(answer, parts=1, draws=2), wr.sweep(jigsaw, [0.01, 0.02])
box = wr.read(BOX)
wr.flex(box, Pull("lid", (1.0, 0.0, 0.0))), wr.check(box)
print(*sorted(loaded() - before), sep="\\n")
"""


@pytest.mark.slow
def test_what_is_compiled_beforehand_answers_questions_of_every_kind() -> None:
    box = ROOT.parents[1] / "examples" / "40_box_with_a_lid" / "box.json"
    assert run(ROOT.parent, f"BOX = {str(box)!r}\n{LOADED}") == ""


ALONE = """
import re
import sys
from importlib.metadata import PackageNotFoundError, packages_distributions, requires

def named(requirement):
    return re.match(r"[\\w.-]+", requirement)[0].lower().replace("_", "-")

there, waiting = set(), [named(one) for one in REQUIRES]
while waiting:
    name = waiting.pop()
    if name not in there:
        there.add(name)
        try:
            waiting += [named(one) for one in requires(name) or () if "extra ==" not in one]
        except PackageNotFoundError:
            pass
for module, packages in packages_distributions().items():
    if module != "wiggleroom" and there.isdisjoint(one.lower().replace("_", "-") for one in packages):
        sys.modules[module] = None
from wiggleroom.cli.compile import compile_kernels, in_space

compile_kernels()
in_space()
"""
"""Compiles with nothing installed but what a wheel is built with."""


@pytest.mark.slow
def test_a_wheel_is_built_with_all_that_compiling_needs() -> None:
    build = tomllib.loads((ROOT.parents[1] / "pyproject.toml").read_text())["build-system"]
    run(ROOT.parent, f"REQUIRES = {build['requires']!r}\n{ALONE}")
