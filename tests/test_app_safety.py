"""The page is for this machine alone; whoever comes from elsewhere, or with something hostile, gets a plain line or nothing."""

from __future__ import annotations

import base64
import contextlib
import http.client
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from email.message import Message
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

import wiggleroom as wr
from tests.app_client import TOKEN, Served, Visit
from wiggleroom.app import websocket_limits as patient
from wiggleroom.cli.options import QuestionOptions
from wiggleroom.cli.serve_command import FirstRequest
from wiggleroom.drawing.writers.assembly_writer import write_assembly

CHAIN = write_assembly(wr.patterns.chain(2, joint="tee", gap=0.02).drawing).encode()


@dataclass
class Got:
    status: int
    headers: Message
    body: bytes


def get(served: Served, target: str, host: str | None = None) -> Got:
    """Raw request: the target goes out as it is."""
    with contextlib.closing(http.client.HTTPConnection("127.0.0.1", served.port, timeout=60)) as asked:
        asked.putrequest("GET", target, skip_host=True)
        asked.putheader("Host", host or f"127.0.0.1:{served.port}")
        asked.endheaders()
        reply = asked.getresponse()
        return Got(reply.status, reply.headers, reply.read())


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost"])
def test_the_page_is_served_with_strict_headers(served: Served, name: str) -> None:
    reply = get(served, f"/?token={TOKEN}", f"{name}:{served.port}")
    assert reply.status == 200
    policy = reply.headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "frame-ancestors 'none'" in policy
    assert reply.headers["X-Content-Type-Options"] == "nosniff"
    assert reply.headers["Referrer-Policy"] == "no-referrer"
    assert reply.headers["Cache-Control"] == "no-store"
    assert reply.headers["Content-Type"].startswith("text/html")


def test_a_wrong_token_gets_nothing(served: Served) -> None:
    assert get(served, "/?token=wrong").status == 403
    for token in ("", "wrong", TOKEN[:-1], TOKEN + "x", "%C3%A9"):
        with pytest.raises(InvalidStatus, match="403"):
            served.socket(token=token)


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "127.0.0.1", "localhost:1"])
def test_another_host_gets_nothing(served: Served, host: str) -> None:
    assert get(served, f"/?token={TOKEN}", host).status == 421
    raw = socket.create_connection(("127.0.0.1", served.port), 10)
    raw.sendall(handshake(served, host=host))
    assert b" 403 " in raw.recv(4096).split(b"\r\n")[0]
    raw.close()


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1", "http://127.0.0.1"])
def test_another_origin_gets_nothing(served: Served, origin: str) -> None:
    with pytest.raises(InvalidStatus, match="403"):
        served.socket(origin=origin)


def handshake(served: Served, host: str | None = None) -> bytes:
    at = f"127.0.0.1:{served.port}"
    key = base64.b64encode(b"0123456789abcdef").decode()
    return (
        f"GET /socket?token={TOKEN} HTTP/1.1\r\nHost: {host or at}\r\nOrigin: http://{host or at}\r\n"
        f"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n"
    ).encode()


@pytest.mark.parametrize(
    "target",
    [
        "/../../../../etc/passwd",
        "/..%2f..%2fpyproject.toml",
        "/web/../palette.py",
        "/%00",
        "/socket",
    ],
)
def test_no_file_of_the_machine_can_be_had(served: Served, target: str) -> None:
    reply = get(served, target)
    assert reply.status in (400, 404, 405)
    assert b"root:" not in reply.body


@pytest.mark.parametrize(
    ("frame", "said"),
    [
        ("garbage", "is not JSON"),
        ("", "is not JSON"),
        ("[1, 2]", "an object"),
        ("[" * 100_000, "message"),
        ('{"kind": "nonsense", "id": 1}', "nonsense"),
        ('{"kind": "flex", "id": -1, "design": {}}', "id"),
        ('{"kind": "flex", "id": 9}', '"design" is missing'),
        ('{"kind": "flex", "id": 9, "design": {"gap": "wide"}}', "a number, not text"),
        ('{"kind": "flex", "id": 9, "design": {"gap": NaN}}', "is not JSON"),
        ('{"kind": "flex", "id": 9, "design": {"gap": 1e999}}', "message"),
        ('{"kind": "flex", "id": 9, "design": {}, "more": 1}', '"more" is not known'),
        ('{"kind": "open", "id": 9, "name": "a.svg", "data": "not base64!"}', "base64"),
        (b"\x00\x01", "text frame"),
    ],
)
def test_wrong_messages_get_a_line_and_the_page_goes_on(page: Visit, frame: str | bytes, said: str) -> None:
    page.socket.send(frame)
    reply = page.next()
    while reply["kind"] == "worker":
        reply = page.next()
    assert reply["kind"] == "failed"
    assert len(reply["findings"]) == 1
    assert said in reply["findings"][0]
    assert "\n" not in reply["findings"][0]
    assert page.open("chain.json", CHAIN)["kind"] == "opened"


BOMB = (
    '<?xml version="1.0"?><!DOCTYPE svg [<!ENTITY a "aaaaaaaaaa">'
    + "".join(f'<!ENTITY {chr(98 + k)} "{f"&{chr(97 + k)};" * 10}">' for k in range(9))
    + "]><svg><text>&j;</text></svg>"
)


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("bomb.svg", BOMB.encode(), "entit"),
        ("outside.svg", b'<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]><svg>&x;</svg>', "entit"),
        ("image.svg", b'<svg><image href="file:///etc/passwd" width="9" height="9"/></svg>', "closed outline"),
        ("nan.json", b'{"format": "wiggleroom/1", "parts": [{"name": "a", "outline": [[NaN, 0], [1, 0], [1, 1]]}]}', "JSON"),
        ("huge.json", b'{"format": "wiggleroom/1", "parts": [{"name": "a", "outline": [[0, 0], [1e300, 0], [1, 1]]}]}', "beyond"),
        ("noise.dxf", bytes(range(256)) * 40, "noise.dxf"),
        ("program.exe", b"MZ", '".exe" files are not read'),
        ("../../etc/passwd", b"root", "are not read"),
        ("a" * 255, b"x", "are not read"),
    ],
)  # fmt: skip
def test_hostile_drawings_get_a_line_without_folders(page: Visit, name: str, data: bytes, said: str) -> None:
    page.open("chain.json", CHAIN)
    reply = page.open(name, data)
    assert reply["kind"] == "failed"
    assert said in reply["findings"][0]
    assert "/tmp" not in json.dumps(reply)
    assert "root:" not in json.dumps(reply)
    assert page.ask("flex")["settled"]  # the drawing before is still open


def test_an_upload_beyond_the_limit_gets_a_line(page: Visit) -> None:
    reply = page.open("large.svg", b" " * 20_500_000)
    assert "20 MB" in reply["findings"][0]


def test_a_message_beyond_all_limits_ends_the_connection(served: Served) -> None:
    with served.visit() as one, contextlib.suppress(ConnectionClosed):
        one.socket.send("x" * 40_000_000)
        while True:
            assert one.next()["kind"] == "worker"
    with served.visit() as one:
        assert one.open("chain.json", CHAIN)["kind"] == "opened"


@pytest.mark.parametrize("pieces", ["fragments", "one frame"])
def test_an_upload_that_never_ends_is_cut_off(served: Served, monkeypatch: pytest.MonkeyPatch, pieces: str) -> None:
    monkeypatch.setattr(patient, "MESSAGE_SECONDS", 0.5)
    raw = socket.create_connection(("127.0.0.1", served.port), 10)
    raw.sendall(handshake(served))
    assert b" 101 " in raw.recv(65536)
    began = time.perf_counter()
    if pieces == "one frame":
        raw.sendall(b"\x81\xfe\xff\xff\0\0\0\0")  # 65535 bytes are announced
    else:
        raw.sendall(b"\x01\x81\0\0\0\0a")  # a text message, to be continued
    with pytest.raises(OSError, match=r"reset|pipe"):  # noqa: PT012
        while time.perf_counter() - began < 30:
            raw.sendall(b"aaaa" if pieces == "one frame" else b"\x00\x81\0\0\0\0a")
            time.sleep(0.05)
    assert 0.4 < time.perf_counter() - began < 20  # by itself it would be a minute
    raw.close()


def run(*words: str, **environment: str) -> subprocess.Popen[str]:
    code = "from wiggleroom.cli import main; raise SystemExit(main())"
    command = [sys.executable, "-c", code, "serve", *words]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env=os.environ | environment)


def children(pid: int) -> list[int]:
    return [int(p) for p in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks at /proc")
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_however_the_server_ends_its_processes_are_gone(tmp_path: Path, end: signal.Signals) -> None:
    (tmp_path / "chain.json").write_bytes(CHAIN)
    (kept := tmp_path / "temporary").mkdir()
    serving = run(str(tmp_path / "chain.json"), "--no-browser", "--gap", "0.03", TMPDIR=str(kept))
    assert serving.stdout is not None
    address = serving.stdout.readline().strip()
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/\?token=[\w-]{43}", address)
    while not (workers := children(serving.pid)):
        time.sleep(0.02)
    serving.send_signal(end)
    assert serving.wait(60) == (0 if end != signal.SIGKILL else -signal.SIGKILL)
    for _ in range(1200):
        if not any(Path(f"/proc/{w}").exists() and "Z" not in status(w) for w in workers):
            break
        time.sleep(0.05)
    else:
        pytest.fail("processes are left")
    serving.communicate()
    assert list(kept.iterdir()) == []


def status(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return "Z"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--gap", "0.2"], "serve: --gap, --fix and the like are about a FILE; name it, or leave them out"),
        (["{chain}", "--fix", "b9"], 'fix: there is no part "b9": the parts are b1, b2'),
        (["{chain}", "--port", "{taken}"], "--port {taken}: it is taken or cannot be had; leave it out, and a free one is found"),
    ],
)  # fmt: skip
def test_what_cannot_be_served_is_said_in_one_line(served: Served, tmp_path: Path, words: list[str], said: str) -> None:
    (tmp_path / "chain.json").write_bytes(CHAIN)
    known = {"chain": str(tmp_path / "chain.json"), "taken": str(served.port)}
    done = run(*(w.format(**known) for w in words), "--no-browser")
    out, err = done.communicate(timeout=120)
    assert (done.returncode, out) == (2, "")
    assert err.strip() == said.format(**known)


def test_pages_of_a_file_begin_with_it_and_its_options(tmp_path: Path) -> None:
    (tmp_path / "chain.json").write_bytes(CHAIN)
    served = Served(FirstRequest(str(tmp_path / "chain.json"), QuestionOptions(gap=0.03, pull=("b2:-x",))))
    try:
        for _ in range(2):  # a page, and the same page reloaded
            with served.visit() as one:
                told = one.until(0, "opened")
                assert (told["name"], told["gap"]) == ("chain.json", 0.03)
                assert told["design"]["goals"] == [{"part": "b2", "direction": [-1.0, 0.0]}]
                one.design = told["design"]
                reply = one.ask("flex")
                assert str(tmp_path / "chain.json") in reply["command"]
        truth = wr.flex(wr.read(tmp_path / "chain.json", gap=0.03), wr.Pull("b2", (-1, 0)), search=0)
        assert reply["objective"] == pytest.approx(truth.objective, rel=1e-9)
    finally:
        served.close()


def test_a_page_that_is_loaded_again_is_about_the_file_as_it_now_is(tmp_path: Path) -> None:
    file = tmp_path / "chain.json"
    file.write_bytes(CHAIN)
    served = Served(FirstRequest(str(file), QuestionOptions()))
    wider = write_assembly(wr.patterns.chain(3, joint="tee", gap=0.05).drawing)
    try:
        for content, parts in ((None, 2), (wider, 3), (wider[:40], 0), (CHAIN.decode(), 2)):
            if content is not None:
                file.write_text(content)
            with served.visit() as one:
                told = one.next()
                if parts:
                    assert (told["kind"], len(told["parts"])) == ("opened", parts)
                else:
                    assert (told["kind"], told["of"]) == ("failed", "open")
                    assert "chain.json" in told["findings"][0]
    finally:
        served.close()


def test_processes_may_not_take_all_memory() -> None:
    resource = pytest.importorskip("resource")
    code = (
        "from wiggleroom.app.resource_limits import bound_memory; import resource; bound_memory(); "
        "print(resource.getrlimit(resource.RLIMIT_DATA)[0])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    whole = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    assert resource.RLIM_INFINITY != int(done.stdout) <= whole / 2


TRAY = {
    "format": "wiggleroom/2",
    "gap": 0.2,
    "unit": "cm",
    "parts": [
        {"name": "west", "boxes": [[-0.2, 0, 0, 0, 1, 1]], "fixed": True},
        {"name": "east", "boxes": [[1, 0, 0, 1.2, 1, 1]], "fixed": True},
        {"name": "block", "boxes": [[0, 0, 0, 1, 1, 1]], "lock": ["y", "z", "rx", "ry", "rz"]},
    ],
    "gaps": [{"parts": ["west", "block"], "gap": 0.03}],
}


@pytest.mark.parametrize("space", [False, True])
def test_pages_begin_with_gaps_of_joints_and_pairs_to_ignore(tmp_path: Path, space: bool) -> None:
    file = tmp_path / ("tray.json" if space else "chain.json")
    file.write_bytes(json.dumps(TRAY).encode() if space else CHAIN)
    part, gap_of = ("block", "block,east:0.7") if space else ("b2", "b1,b2:0.03")
    asked = QuestionOptions(gap=0.2 if space else None, gap_of=(gap_of,), ignore=("west,block",) if space else ())
    served = Served(FirstRequest(str(file), replace(asked, pull=(f"{part}:+x",))))
    try:
        with served.visit() as one:
            one.design = one.until(0, "opened")["design"]
            reply = one.ask("flex")
            saved = tmp_path / "saved.json"
            saved.write_bytes(base64.b64decode(one.ask("save", what="assembly", of="flex")["data"]))
    finally:
        served.close()
    again = wr.flex(wr.read(saved), wr.Pull(part, (1, 0, 0) if space else (1, 0)))
    assert reply["objective"] == pytest.approx(again.objective, abs=1e-7)
    assert f"--gap-of {gap_of}" in reply["command"]
    if space:  # the block meets the east wall, at the gap of that joint
        assert reply["objective"] == pytest.approx(0.7, abs=1e-7)
        assert "--ignore west,block" in reply["command"]
        assert json.loads(saved.read_text())["gaps"][1]["gap"] == pytest.approx(0.07)
    else:
        assert reply["objective"] == pytest.approx(wr.flex(wr.read(file, gap=0.03), wr.Pull(part, (1, 0))).objective)


def test_files_that_a_file_names_are_read_again_when_they_change(tmp_path: Path) -> None:
    file, sheet = tmp_path / "tray.json", tmp_path / "sheet.svg"
    panel = {"name": "panel", "outline": "sheet.svg#panel", "thickness": 3, "at": [0, 0, 9]}
    plain = {"name": "ground", "boxes": [[0, 0, 0, 9, 9, 3]], "fixed": True}
    file.write_text(json.dumps({"format": "wiggleroom/2", "parts": [plain, panel]}))
    drawn = (
        "<svg xmlns='http://www.w3.org/2000/svg' width='90mm' height='90mm' viewBox='0 0 90 90'>"
        "<rect id='panel' width='{}' height='9'/></svg>"
    )
    sheet.write_text(drawn.format(9))
    first = FirstRequest(str(file), QuestionOptions())
    before = first()
    assert first() is before
    sheet.write_text(drawn.format(10))
    (now,) = json.loads(first())["beside"].values()
    assert base64.b64decode(now) == sheet.read_bytes()
    sheet.unlink()
    with pytest.raises(wr.InputError, match=r"sheet\.svg"):
        first()


def test_only_the_files_of_the_page_are_there(served: Served) -> None:
    folder = Path(wr.__file__).parent / "report" / "web"
    for file in folder.iterdir():
        assert get(served, f"/{file.name}").body == file.read_bytes()
