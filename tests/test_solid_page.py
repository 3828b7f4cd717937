"""Pages, films and models of assemblies in space: what they carry, and that names are only ever data."""

from __future__ import annotations

import base64
import hashlib
import io
import itertools
import json
import re
import struct
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import wiggleroom as wr
from tests.test_spatial import PEG, PLATE, spatial
from wiggleroom.app.spatial_samples import SPATIAL_SAMPLES
from wiggleroom.errors import InputError
from wiggleroom.report.page.solid_page import page_of_separation, page_of_spatial_answer, page_of_spatial_assembly
from wiggleroom.report.solids.exploded_view import exploded_offsets
from wiggleroom.report.solids.spatial_path import along_path
from wiggleroom.search.answer import Answer

NASTY = "</script><img src=x onerror=alert(1)>"


def scene(page: str) -> dict:
    return json.loads(re.search(r'id="solid">(.*?)</script>', page, re.DOTALL)[1])


def unpacked(text: str, kind: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype=kind)


def test_the_page_carries_parts_path_and_contacts() -> None:
    answer = wr.flex(spatial(PLATE, PEG), wr.Turn("peg", (0, 0, 1)))
    page = page_of_spatial_answer(answer, "wiggleroom flex peg.json")
    data = scene(page)
    assert [p["name"] for p in data["parts"]] == ["plate", "peg"]
    motions = unpacked(data["motions"], "<f4").reshape(*answer.waypoints.shape[:2], 7)
    turn = Rotation.from_quat(motions[-1, 1, 3:]).as_rotvec()
    assert turn == pytest.approx(answer.motion[1, 3:], abs=1e-6)
    assert motions[-1, 1, :3] == pytest.approx(answer.motion[1, :3], abs=1e-6)
    peg = answer.assembly.solids[1].surface
    corners = unpacked(data["parts"][1]["vertices"], "<f4").reshape(-1, 3) + data["parts"][1]["reference"]
    assert corners == pytest.approx(peg.vertices, abs=1e-5)
    assert len(data["contacts"]) == len(answer.contacts) > 0
    assert data["times"][0] == 0
    assert data["times"][-1] == 1
    assert "optimal" in page


def test_names_are_data_and_only_the_bundle_may_run() -> None:
    answer = wr.flex(spatial(PLATE, PEG | {"name": NASTY}), wr.Turn(NASTY, (0, 0, 1)))
    page = page_of_spatial_answer(answer, f"wiggleroom flex '{NASTY}'")
    assert NASTY not in page
    assert scene(page)["parts"][1]["name"] == NASTY
    script = re.search(r'<script type="module">(.*)</script>', page, re.DOTALL)[1]
    allowed = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]
    assert policy.startswith("default-src 'none'")
    assert f"script-src 'sha256-{allowed}'" in policy
    assert "unsafe" not in policy


def test_a_path_apart_is_a_page_too_and_answers_draw_themselves(tmp_path: Path) -> None:
    found = wr.check(spatial(PLATE, PEG))
    data = scene(page_of_separation(found))
    assert len(data["times"]) >= sum(len(e.path) for e in found.escapes)
    for name in ("a.html", "a.svg", "a.glb"):
        found.draw(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 500
    with pytest.raises(wr.InputError, match="must end in"):
        found.draw(tmp_path / "a.bmp")


def test_what_flies_off_is_seen_most_of_the_time() -> None:
    assembly = spatial(PLATE, PEG)
    size = assembly.size
    path = np.zeros((2, 2, 6))
    path[1, 1, 2] = 50 * size
    shares = np.linspace(0, 1, 1001)
    far = along_path(assembly, path, shares)[:, 1, 2]
    evenly = np.interp(
        shares, [0, 0.8 / 1.3, 1], [0, 0.8 * size, 50 * size]
    )  # 0.8 in sight, and 0.5 for all that is not
    assert far == pytest.approx(evenly, abs=1e-9 * size)
    path = np.concatenate([path, path[1:]])
    path[2, 0, 0] = 0.3 * size  # the other one then moves in sight, and counts in full
    x = along_path(assembly, path, shares)[:, 0, 0]
    assert x == pytest.approx(np.interp(shares, [0, 1.3 / 1.6, 1], [0, 0, 0.3 * size]), abs=1e-9 * size)


def test_parts_with_one_centre_are_apart_in_an_exploded_view(tmp_path: Path) -> None:
    path = tmp_path / "burr.json"
    path.write_text(SPATIAL_SAMPLES["burr"].text())
    burr = wr.read(path)
    corners = [m.surface.vertices + p.at for m, p in zip(burr.solids, burr.parts, strict=True)]
    lows, highs = (np.array([f(c, axis=0) for c in corners]) + exploded_offsets(burr) for f in (np.min, np.max))
    for i, j in itertools.combinations(range(len(corners)), 2):
        assert ((highs[i] <= lows[j]) | (highs[j] <= lows[i])).any()


@pytest.mark.slow
def test_it_prints_light_and_whole(opened: Any) -> None:
    pegs = [PEG | {"name": f"peg {k}", "at": [20 * k, 0, 0]} for k in range(60)]
    at = opened(page_of_spatial_assembly(spatial(*pegs)))
    at.emulate_media(media="print", color_scheme="dark")
    assert at.locator("body").evaluate("(body) => getComputedStyle(body).backgroundColor") == "rgb(255, 255, 255)"
    for one in ("aside", "body"):
        assert at.locator(one).evaluate("(element) => element.scrollHeight - element.clientHeight") == 0
    assert not at.locator("#play").is_visible()
    assert at.get_by_text("peg 59").is_visible()


# -- films and models ------------------------------------------------------------------------------------------------


TILTED = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
"""In glTF y is up."""


@pytest.fixture(scope="module")
def answer() -> Answer:
    return wr.flex(spatial(PLATE, PEG, gap=0.1), wr.Turn("peg", (0, 0, 1)))


def test_a_model_holds_the_end_and_its_animation_begins_at_rest(answer: Answer, tmp_path: Path) -> None:
    answer.draw(tmp_path / "moved.glb")
    data = (tmp_path / "moved.glb").read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    content, binary = json.loads(data[20 : 20 + size]), data[28 + size :]
    peg = trimesh.load(io.BytesIO(data), file_type="glb").geometry["peg"]
    made, part = answer.assembly.solids[1], answer.assembly.parts[1]
    rest = made.surface.vertices @ part.R.T + part.at

    def values(k: int, width: int) -> np.ndarray:
        entry = content["accessors"][k]
        view = content["bufferViews"][entry["bufferView"]]
        found = np.frombuffer(binary, "<f4", entry["count"] * width, view["byteOffset"])
        return found.reshape(-1, width)

    animation = content["animations"][0]
    by = {c["target"]["path"]: animation["samplers"][c["sampler"]]["output"] for c in animation["channels"]}
    assert {content["nodes"][c["target"]["node"]]["name"] for c in animation["channels"]} == {"peg"}
    shift, turn = values(by["translation"], 3), values(by["rotation"], 4)
    x, y, z, w = turn[0]
    first = trimesh.transformations.quaternion_matrix([w, x, y, z])[:3, :3]
    begun = 1000 * (peg.vertices @ first.T + shift[0]) @ TILTED
    assert np.abs(np.sort(begun, axis=0) - np.sort(rest, axis=0)).max() < 1e-3
    assert np.allclose(turn[-1], (0, 0, 0, 1), atol=1e-6)
    assert np.allclose(shift[-1], 0, atol=1e-7)


def test_films_have_the_endings_of_the_plane(answer: Answer, tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    answer.draw(tmp_path / "way.gif")
    shots = []
    with image.open(tmp_path / "way.gif") as film:
        assert film.n_frames > 20
        for k in (0, film.n_frames // 2):
            film.seek(k)
            shots.append(np.asarray(film.convert("RGB"), dtype=int))
    assert np.abs(shots[0] - shots[1]).max() > 50  # something moved
    answer.draw(tmp_path / "way.film.svg")
    frames = ET.parse(tmp_path / "way.film.svg").getroot().findall("{http://www.w3.org/2000/svg}g")
    shown = [f.find("{http://www.w3.org/2000/svg}animate") for f in frames]
    for t in np.linspace(0.001, 0.999, 57):  # one frame at a time, at all times
        seen = 0
        for one in shown:
            keys = [float(k) for k in one.get("keyTimes").split(";")]
            seen += one.get("values").split(";")[int(np.searchsorted(keys, t, side="right")) - 1] == "inline"
        assert seen == 1


def test_a_film_of_ways_out_shows_every_escape(tmp_path: Path) -> None:
    found = wr.check(spatial(PLATE, PEG, gap=0.1))
    found.draw(tmp_path / "out.film.svg")
    assert "1. peg in" in (tmp_path / "out.film.svg").read_text()


def test_studies_have_no_film(answer: Answer, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="films come from"):
        wr.rank(answer).draw(tmp_path / "rank.gif")
    with pytest.raises(InputError, match="must end in"):
        answer.draw(tmp_path / "way.bmp")
