"""Films and models of paths in space: they begin at rest and end where the answer ends."""

from __future__ import annotations

import io
import json
import struct
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import trimesh

import wiggleroom as wr
from tests.test_spatial import PEG, PLATE, spatial
from wiggleroom.errors import InputError
from wiggleroom.search.answer import Answer

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
