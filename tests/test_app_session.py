"""The newest request counts, long work gives way to the hand, and a process that dies costs only time."""

from __future__ import annotations

import asyncio
import base64
import json
import os
import signal
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

import wiggleroom as wr
from tests.app_client import Served, Visit
from wiggleroom.app import session
from wiggleroom.app.warming import Warming
from wiggleroom.app.worker_protocol import Done, Outgoing, StartOrder
from wiggleroom.assembly.build import assemble
from wiggleroom.drawing.writers.assembly_writer import write_assembly

GRID = wr.patterns.grid(5, 5, joint="tee", gap=0.02)


def text(assembly: wr.Assembly) -> bytes:
    return write_assembly(assembly.drawing).encode()


@pytest.fixture
def page(served: Served) -> Iterator[Visit]:
    with served.visit() as one:
        yield one


def test_of_a_hundred_quick_requests_few_are_answered_and_the_last_one_rightly(page: Visit) -> None:
    chain = wr.patterns.chain(8, joint="tee", gap=0.02)
    page.open("chain.json", text(chain))
    gaps = [0.02 + 0.0001 * k for k in range(100)]
    for gap in gaps:
        page.design["gap"] = gap
        last = page.send("flex")
        time.sleep(0.002)
    page.told.clear()
    reply = page.until(last, "flex")
    answered = {r["id"] for r in page.told if r["kind"] == "flex"}
    assert len(answered) < 40
    assert sorted(answered) == list(dict.fromkeys(r["id"] for r in page.told if r["kind"] == "flex"))
    truth = wr.flex(assemble(chain.drawing, gap=gaps[-1]), search=0)
    assert reply["objective"] == pytest.approx(truth.objective, rel=1e-6)


def test_what_is_cancelled_is_not_answered_and_holds_nothing_up(page: Visit) -> None:
    page.open("grid.json", text(wr.patterns.grid(24, 24, joint="tee", gap=0.02)))
    number = page.send("flex")
    while page.next().get("stage") != "solve":
        pass
    began = time.perf_counter()
    page.send("cancel", of="flex")
    page.ask("shape")
    assert time.perf_counter() - began < 20.0  # half a second on an idle machine; the whole answer takes much longer
    page.told.clear()
    page.ask("shape")
    assert all(r["id"] != number or r["kind"] == "progress" for r in page.told)


def test_long_work_gives_way_to_the_hand_and_begins_again(page: Visit) -> None:
    page.open("grid.json", text(GRID))
    page.ask("flex")
    long = page.send("check")
    page.next()
    quick = page.send("flex")
    page.told.clear()
    reply = page.until(long, "check")
    kinds = [r["kind"] for r in page.told if r["kind"] != "progress"]
    assert kinds.index("flex") < kinds.index("check")
    assert [r["id"] for r in page.told if r["kind"] == "flex"] == [quick] * kinds.count("flex")
    assert reply["verdict"] == wr.check(GRID).verdict


@pytest.mark.slow
def test_a_short_question_is_answered_while_a_study_is_under_way(page: Visit) -> None:
    page.open("grid.json", text(GRID))
    page.ask("flex")
    long = page.send("study", of="sample", options={"spread": 0.001, "draws": 24})
    while page.next().get("kind_of") != "sample":
        pass
    short = page.send("rank")
    ended: list[int] = []
    while len(ended) < 2:
        reply = page.next()
        assert reply["kind"] != "failed"
        ended += [reply["id"]] if reply["kind"] in ("rank", "study") else []
    assert ended == [short, long]


def test_a_request_whose_process_dies_twice_is_given_up_and_the_page_goes_on(served: Served, page: Visit) -> None:
    page.open("grid.json", text(GRID))
    number = page.send("check")
    for _ in range(2):
        while page.next()["kind"] != "progress":
            pass
        os.kill(served.workers()[0], signal.SIGKILL)
        while page.next().get("state") != "restarted":
            pass
    reply = page.until(number, "check")
    assert reply["kind"] == "failed"
    assert "ended 2 times" in reply["findings"][0]
    assert page.ask("flex")["settled"]


def test_a_drawing_that_takes_too_long_to_read_is_given_up(page: Visit, monkeypatch: pytest.MonkeyPatch) -> None:
    page.open("grid.json", text(GRID))
    rings = "".join(f"<circle cx='{k % 200 * 10}' cy='{k // 200 * 10}' r='4'/>" for k in range(40_000))
    monkeypatch.setattr(session, "READ_SECONDS", 0.3)
    reply = page.open(
        "big.svg", f"<svg xmlns='http://www.w3.org/2000/svg' width='2000mm' height='2000mm'>{rings}</svg>".encode()
    )
    assert "was not read within" in reply["findings"][0]
    monkeypatch.setattr(session, "READ_SECONDS", 60.0)
    assert page.ask("flex")["settled"]  # about the drawing before


def test_a_drawing_that_is_replaced_at_once_still_counts_where_the_next_is_bad(page: Visit) -> None:
    good = text(wr.patterns.chain(3, joint="tee", gap=0.02))
    for _ in range(10):  # the next one comes while the first is just done
        page.open("good.json", good)
        assert page.open("bad.json", good[:50])["kind"] == "failed"
        assert page.ask("flex")["settled"]


def test_two_pages_have_a_drawing_each(served: Served) -> None:
    with served.visit() as one, served.visit() as other:
        one.open("a.json", text(wr.patterns.chain(3, joint="tee", gap=0.02)))
        other.open("b.json", text(wr.patterns.chain(4, joint="swallowtail", gap=0.01)))
        numbers = [visit.send("flex") for visit in (one, other)]
        found = [visit.until(n)["objective"] for visit, n in zip((one, other), numbers, strict=True)]
    truth = [
        wr.flex(wr.patterns.chain(3, joint="tee", gap=0.02), search=0).objective,
        wr.flex(wr.patterns.chain(4, joint="swallowtail", gap=0.01), search=0).objective,
    ]
    assert found == pytest.approx(truth, rel=1e-6)


def test_a_fifth_page_is_told_why_not_and_has_room_later(served: Served) -> None:
    import contextlib

    with contextlib.ExitStack() as open_pages:
        for _ in range(4):
            open_pages.enter_context(served.visit())
        with served.socket() as fifth:
            assert "4 pages are open" in Visit(fifth).next()["findings"][0]
    for _ in range(200):  # until those that left are gone
        with served.socket() as later:
            one = Visit(later)
            if one.next()["kind"] == "hello":
                assert one.open("a.json", text(wr.patterns.chain(2, gap=0.02)))["kind"] == "opened"
                return
        time.sleep(0.1)
    pytest.fail("there is no room later")


def test_pages_that_leave_take_their_processes_along(served: Served) -> None:
    with served.visit() as one:
        one.open("a.json", text(wr.patterns.chain(2, gap=0.02)))
        (pid,) = served.workers()
    for _ in range(600):
        if not alive(pid):
            return
        time.sleep(0.05)
    pytest.fail("the process is still there")


def test_a_process_that_is_killed_while_it_reads_leaves_no_file_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(tempfile, "tempdir", None)  # it is looked for anew
    rings = "".join(f"<path d='M{k} 0 h0.5 v0.5 h-0.5 z'/>" for k in range(40_000))
    drawing = f"<svg xmlns='http://www.w3.org/2000/svg' width='1mm' height='1mm'>{rings}</svg>".encode()
    one = Served()
    try:
        with one.visit() as page:
            page.send("open", name="secret.svg", data=base64.b64encode(drawing).decode())
            for _ in range(6000):
                if any(tmp_path.rglob("secret.svg")):
                    break
                time.sleep(0.01)
            else:
                pytest.fail("it is not read from a file")
            os.kill(one.workers()[0], signal.SIGKILL)
            while page.next().get("state") != "restarted":
                pass
    finally:
        one.close()
    # the server of the other tests may have begun a process meanwhile, whose folder is empty
    assert [file for file in tmp_path.rglob("*") if not file.is_dir()] == []


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1])
def test_whatever_comes_in_whatever_order_the_last_question_is_answered(served: Served, seed: int) -> None:
    rng = np.random.default_rng(seed)
    chain = wr.patterns.chain(5, joint="tee", gap=0.02)
    drawing = base64.b64encode(text(chain)).decode()
    with served.visit() as one:
        one.open("chain.json", text(chain))
        for _ in range(120):
            one.design["gap"] = float(rng.uniform(0.01, 0.03))
            match int(rng.integers(0, 14)):
                case 0:
                    one.send("open", name="chain.json", data=drawing)
                case 1:
                    one.send("open", name="bad.json", data=drawing[:40])
                case 2:
                    one.send("cancel", of=str(rng.choice(["flex", "check", "drag", "sweep", "nothing"])))
                case 3:
                    one.socket.send("noise")
                case 4 if served.workers() and rng.random() < 0.3:
                    os.kill(served.workers()[0], signal.SIGKILL)
                case 5 | 6:
                    one.send("flex")
                case 7 | 8 | 9:
                    one.send("drag", part="b5", grip=[4.0, 0.0], target=rng.normal((4, 0), 0.1).tolist())
                case kind:
                    one.send(["rank", "check", "sweep", "wiggle"][kind % 4])
            time.sleep(float(rng.choice([0.0, 0.0, 0.01, 0.2])))
        one.send("open", name="chain.json", data=drawing)
        one.design["gap"] = 0.025
        reply = one.until(one.send("flex"), "flex")
    assert reply["objective"] == pytest.approx(
        wr.flex(assemble(chain.drawing, gap=0.025), search=0).objective, rel=1e-6
    )


@pytest.mark.slow
def test_memory_stays_flat_while_parts_are_dragged(served: Served, page: Visit) -> None:
    told = page.open("grid.json", text(GRID))
    rng = np.random.default_rng(0)
    (pid,) = served.workers()
    sizes = []
    for k in range(300):
        part = told["parts"][int(rng.integers(1, len(told["parts"])))]
        target = np.add(part["at"][:2], rng.normal(0, 0.1, 2)).tolist()
        page.until(page.send("drag", part=part["name"], grip=part["at"][:2], target=target), "drag")
        page.told.clear()
        if k in (100, 299):
            sizes.append(memory(pid))
    assert sizes[1] < sizes[0] + 20


def memory(pid: int) -> float:
    """What a process holds [MB]."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


class Solver:
    """A process whose words the test chooses."""

    def __init__(self) -> None:
        self.orders: asyncio.Queue[StartOrder] = asyncio.Queue()
        self.words: asyncio.Queue[Outgoing | Done] = asyncio.Queue()
        self.stopped: list[int] = []
        self.killed = 0
        self.warming = Warming(self.prepare)
        self.warming.done = True

    async def prepare(self) -> None:
        return None

    async def take(self) -> Solver:
        return self

    async def drop(self, _: Solver) -> None:
        return None

    async def send(self, order: StartOrder) -> None:
        await self.orders.put(order)

    async def receive(self) -> Outgoing | Done:
        return await self.words.get()

    def stop(self, ticket: int) -> None:
        self.stopped.append(ticket)

    def kill(self) -> None:
        self.killed += 1


@pytest.mark.parametrize(
    ("told", "opens", "orders"),
    [
        (True, False, ["check", "shape"]),
        (False, False, ["check", "shape", "check"]),
        (False, True, ["check", "open"]),
    ],
)
def test_what_was_answered_before_it_could_be_stopped_is_not_answered_again(
    monkeypatch: pytest.MonkeyPatch, told: bool, opens: bool, orders: list[str]
) -> None:
    monkeypatch.setattr(session, "IDLE_SECONDS", 0.05)
    solver, sent, seen = Solver(), [], []

    async def send(_: list[bytes], said: bytes) -> None:
        sent.append(said)

    async def answer(order: StartOrder) -> None:
        await solver.words.put(Outgoing(order.ticket, order.request))
        await solver.words.put(Done(order.ticket))

    async def play() -> None:
        one = session.Session(solver, send)  # type: ignore[arg-type]
        work = asyncio.create_task(one.run())
        await one.submit(b'{"kind": "check", "id": 1, "design": {}}')
        first = await solver.orders.get()
        seen.append(first.request)
        await one.submit(
            b'{"kind": "shape", "id": 3, "design": {}}'
        )  # it is to stop for this, and may have been done just then
        assert solver.stopped == [first.ticket]
        if opens:
            await one.submit(b'{"kind": "open", "id": 2, "name": "a.svg", "data": ""}')
        if told:
            await answer(first)
        else:
            await solver.words.put(Done(first.ticket, good=False))
        with suppress(TimeoutError):
            while True:  # what is meant to come may take long; then a while for what is not
                order = await asyncio.wait_for(solver.orders.get(), 30 if len(seen) < len(orders) else 0.5)
                seen.append(order.request)
                await answer(order)
        while len(sent) < len(orders) - (not told):
            await asyncio.sleep(0.01)
        work.cancel()

    with ThreadPoolExecutor(1) as thread:  # a browser, where one is open, has this thread's loop
        thread.submit(asyncio.run, asyncio.wait_for(play(), 120)).result()
    assert [json.loads(text)["kind"] for text in seen] == orders
    assert [json.loads(text)["kind"] for text in sent] == orders[not told :]
