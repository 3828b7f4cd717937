"""Whoever is slow, large or loud at the server of the page is cut off or waits; nobody else does."""

from __future__ import annotations

import itertools
import json
import socket
import struct
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest
from benchmarks import attack_server
from benchmarks.attack_server import ATTACKS, Target, frame, serving, under

from tests.app_client import TOKEN, Served, Visit
from tests.page_waits import PATIENCE
from tests.test_app_safety import CHAIN, get
from wiggleroom.app import http_limits


@pytest.fixture(scope="module")
def attacked() -> Iterator[Target]:
    with serving() as target:
        yield target


@pytest.mark.parametrize("first", range(0, len(ATTACKS), 3))
def test_a_page_and_newcomers_are_served_under_attack(
    attacked: Target, first: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By three attacks at once."""
    monkeypatch.setattr(attack_server, "PATIENCE", 20.0)  # machines that run tests are busy

    def together(target: Target, stop: attack_server.Stop) -> None:
        with ThreadPoolExecutor(3) as pool:
            list(pool.map(lambda attack: attack(target, stop), ATTACKS[first : first + 3]))

    found = under(together, attacked, 1.0)
    assert found.held, found
    assert found.newcomers.seconds


def cut_off(raw: socket.socket, drip: bytes) -> float:
    """Seconds until the server ends a connection on which something is sent now and then."""
    began = time.perf_counter()
    raw.settimeout(0.05)
    while time.perf_counter() - began < 30:
        try:
            if drip:
                raw.send(drip)
            if raw.recv(65536) == b"":
                break
        except TimeoutError:
            continue
        except OSError:
            break
    return time.perf_counter() - began


@pytest.mark.parametrize(
    ("first", "drip"),
    [
        (b"", b""),
        (b"GET / HTTP/1.1\r\nHost: a\r\nX: ", b"a"),
        (b"POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 1000000\r\n\r\n", b"a"),
        (b"GET /page.css HTTP/1.1\r\nHost: a\r\n\r\nGET / HTTP/1.1\r\nX: ", b"a"),
    ],
    ids=["idle", "headers", "body", "second request"],
)
def test_a_request_that_does_not_end_is_cut_off(
    served: Served, monkeypatch: pytest.MonkeyPatch, first: bytes, drip: bytes
) -> None:
    monkeypatch.setattr(http_limits, "REQUEST_SECONDS", 0.5)
    with socket.create_connection(("127.0.0.1", served.port), 60) as raw:
        raw.sendall(first)
        assert 0.3 < cut_off(raw, drip) < 15  # by itself it would be twenty seconds


def test_giant_headers_are_refused(served: Served) -> None:
    with socket.create_connection(("127.0.0.1", served.port), 60) as raw:
        raw.sendall(b"GET / HTTP/1.1\r\nX: " + b"a" * 20_000)
        assert b" 400 " in raw.recv(4096)


def test_half_requests_take_nobodys_place(served: Served) -> None:
    held = []
    try:
        for _ in range(150):
            held.append(raw := socket.create_connection(("127.0.0.1", served.port), 60))
            raw.sendall(b"GET / HTTP/1.1\r\nX: ")
        for _ in range(5):
            assert get(served, f"/?token={TOKEN}").status == 200
    finally:
        for raw in held:
            raw.close()


def test_a_frame_beyond_all_limits_is_refused_by_its_head(attacked: Target) -> None:
    with attacked.page() as raw:
        raw.sendall(b"\x81\xff" + struct.pack(">Q", 1 << 40) + bytes(4))
        assert 0 <= cut_off(raw, b"") < 15


def test_pieces_of_a_message_come_together_however_they_are_cut(served: Served) -> None:
    """A message of a megabyte in uneven pieces, with pings in between, is answered as if it had come whole."""
    text = json.dumps({"kind": "nonsense", "id": 7, "filler": "a" * 1_000_000}).encode()
    target = Target(served.port, TOKEN)
    with target.page() as raw:
        cuts = [0, 1, 130, 70_000, 70_001, 500_000, len(text)]
        for a, b in itertools.pairwise(cuts):
            raw.sendall(frame(text[a:b], 1 if a == 0 else 0, b == len(text)) + frame(b"ping", 9))
        said = b""
        raw.settimeout(60)
        while b"nonsense" not in said:
            said += raw.recv(65536)
    assert b'"id":7' in said.replace(b" ", b"")
    assert said.count(b"\x8a\x04ping") == len(cuts) - 1


def test_a_message_that_is_no_drawing_has_a_limit_of_its_own(page: Visit) -> None:
    page.open("chain.json", CHAIN)
    reply = page.ask("flex", design=page.design | {"glue": [["b1", "b2"]] * 120_000})
    assert "1 MB" in reply["findings"][0]


def test_a_path_does_not_lift_the_limit_of_an_upload(page: Visit) -> None:
    reply = page.open("large.svg", b" " * 20_500_000, path="/home/somebody/large.svg")
    assert "20 MB" in reply["findings"][0]


def test_the_bare_address_says_in_one_sentence_what_to_do(served: Served) -> None:
    for target, status in (("/", 403), ("/?token=", 403), ("/?token=wrong", 403)):
        reply = get(served, target)
        assert reply.status == status
        said = reply.body.decode()
        assert "open the whole address that <code>wiggleroom serve</code> printed" in said
        assert said.count("<p>") == 1
        assert TOKEN not in said
        assert "unsafe" not in reply.headers["Content-Security-Policy"]


@pytest.mark.slow
def test_a_reload_comes_back_and_a_copied_address_is_explained(served: Served, browser: object) -> None:
    context = browser.new_context()  # type: ignore[attr-defined]
    context.set_default_timeout(1000 * PATIENCE)
    page = context.new_page()
    page.goto(f"http://127.0.0.1:{served.port}/?token={TOKEN}")
    page.wait_for_function("!location.search.includes('token')")
    page.reload()
    page.wait_for_selector("#page > *")
    assert "This address lacks" not in page.inner_text("body")
    bare = page.url
    other = browser.new_context().new_page()  # type: ignore[attr-defined]
    other.goto(bare)
    assert "This address lacks the token" in other.inner_text("body")
    context.close()
    other.context.close()
