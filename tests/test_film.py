"""Films: what moves must be where the path says, the files must be what their names say."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import wiggleroom as wr
from tests.answers import answer, block, row
from wiggleroom.drawing.model import Part, Pull, Turn
from wiggleroom.report.films import scene as scenes
from wiggleroom.report.films.film import film, film_of_answer
from wiggleroom.report.films.scene import Caption, Scene, scene
from wiggleroom.report.write_picture import write_picture
from wiggleroom.verdict import Verdict

SVG = "{http://www.w3.org/2000/svg}"


def made(case: wr.Answer, **changes: object) -> Scene:
    return scene(case.assembly, case.waypoints, Caption("t", goals=case.goals), **({"rate": 10.0} | changes))


@pytest.mark.parametrize("shape", [(2, 3), (0, 5, 3), (2, 4, 3), (2, 5, 2)])
def test_a_path_of_another_shape_is_refused(shape: tuple[int, ...], tmp_path: Path) -> None:
    with pytest.raises(wr.InputError, match="waypoints"):
        film(row(5).assembly, np.zeros(shape), tmp_path / "a.svg")
    with pytest.raises(wr.InputError, match="finite"):
        film(row(5).assembly, np.full((2, 5, 3), np.nan), tmp_path / "a.svg")
    assert not list(tmp_path.iterdir())


def test_other_endings_are_refused(tmp_path: Path) -> None:
    case = row(2)
    with pytest.raises(wr.InputError, match=r"\.gif"):
        film(case.assembly, case.waypoints, tmp_path / "a.avi")
    with pytest.raises(wr.InputError, match=r"\.html"):
        write_picture(case, tmp_path / "a.pdf")


def animated(svg: str) -> list[ElementTree.Element]:
    return list(ElementTree.fromstring(svg.encode()).iter(f"{SVG}animateTransform"))


def test_the_moving_svg_goes_from_rest_to_the_end_and_back(tmp_path: Path) -> None:
    case = row(3, lift=0.5)
    film_of_answer(case, tmp_path / "a.svg")
    svg = (tmp_path / "a.svg").read_text()
    tags = animated(svg)
    shifts = [t for t in tags if t.get("type") == "translate"]
    turns = [t for t in tags if t.get("type") == "rotate"]
    assert len(turns) == 2  # b1 stands still
    times = [float(t) for t in tags[0].get("keyTimes", "").split(";")]
    assert times[0] == 0.0
    assert times[-1] == 1.0
    assert times == sorted(times)
    bar = re.search(r"v5h([\d.]+)v-5.*?>([\d.]+) mm<", svg)
    assert bar
    scale = float(bar[1]) / float(bar[2])
    ups = []
    for tag in shifts[:2]:
        values = np.array([v.split() for v in tag.get("values", "").split(";")], dtype=float)
        assert len(values) == len(times)
        np.testing.assert_allclose(values[0], values[-1])
        ups.append((values[0, 1] - values[:, 1].min()) / scale)
    np.testing.assert_allclose(ups, [0.25, 0.5], rtol=0.01)
    degrees = [max(abs(float(v)) for v in t.get("values", "").split(";")) for t in turns]
    np.testing.assert_allclose(degrees, np.degrees([0.01, 0.02]), atol=2e-3)


def leaving() -> wr.Answer:
    parts = [Part("case", (block(10.0, hole=4.0),), fixed=True), Part("drawer", (block(3.0),))]
    return answer(
        parts,
        [(0, 0, 0), (400.0, 0, 0.0)],
        (Pull("drawer", (1, 0)),),
        None,
        verdict=Verdict.UNBOUNDED,
        leaves=("drawer",),
    )


def test_what_goes_far_away_fades_and_the_frame_stays_near() -> None:
    scene_of = made(leaving())
    drawer = scene_of.tracks[0]
    assert drawer.opacity[0] == 1
    assert drawer.opacity[-1] <= scenes.MIN_OPACITY
    assert (np.diff(drawer.opacity) <= 0).all()
    assert scene_of.stage[2] < 2.5 * scene_of.stage[3]
    seen = (drawer.opacity > scenes.MIN_OPACITY).mean()
    assert seen > 0.5  # the film ends soon after it is gone


def test_gif_plays_with_pauses(tmp_path: Path) -> None:
    images = pytest.importorskip("PIL.Image")
    drawn: list[tuple[int, int]] = []
    film_of_answer(row(3), tmp_path / "a.gif", progress=lambda k, n: drawn.append((k, n)))
    with images.open(tmp_path / "a.gif") as gif:
        assert gif.info["loop"] == 0
        frames, waits = gif.n_frames, []
        for k in range(frames):
            gif.seek(k)
            waits.append(gif.info["duration"])
        assert gif.convert("RGB").getpixel((2, 2)) == (255, 255, 255)
    assert drawn[-1] == (len(drawn), len(drawn))
    assert waits[0] >= 500
    assert sorted(waits)[-2:] == [waits[0], max(waits)]
    assert 2000 <= sum(waits) <= 10000


@pytest.mark.slow
def test_mp4_is_h264_at_30_frames_a_second(tmp_path: Path) -> None:
    av = pytest.importorskip("av")
    film_of_answer(leaving(), tmp_path / "a.mp4")
    with av.open(str(tmp_path / "a.mp4")) as box:
        stream = box.streams.video[0]
        assert stream.codec_context.name == "h264"
        assert stream.average_rate == 30
        assert stream.width % 2 == stream.height % 2 == 0
        assert 2 <= float(stream.duration * stream.time_base) <= 8
        frames = list(box.decode(video=0))
        first, middle = (f.to_ndarray(format="rgb24").astype(int) for f in (frames[0], frames[len(frames) // 2]))
    assert np.abs(first - middle).max() > 60


@pytest.mark.parametrize("scale", [0.003, 4000.0])
def test_any_size_and_any_question_makes_a_film(scale: float, tmp_path: Path) -> None:
    case = row(4, scale=scale, shift=1000 * scale)
    goals = (
        Turn("b3", "cw"),
        wr.W("b2", (0.0, 0.0, 1.0)),
        wr.W("b2", (1.0, 0.0, 0.0)),
        Pull("b4", (0.6, 0.8), (0.1, 0.2)),
    )
    film_of_answer(replace(case, goals=goals), tmp_path / "a.svg")
    still = replace(case, waypoints=case.waypoints[:1], motion=0 * case.motion)
    film_of_answer(still, tmp_path / "b.svg")
    for name in "ab":
        svg = (tmp_path / f"{name}.svg").read_text()
        assert not re.search(r"\bnan\b|\binf\b", svg)
        ElementTree.fromstring(svg.encode())


def test_names_in_films_are_escaped(tmp_path: Path) -> None:
    parts = [Part("<script>&", (block(),), fixed=True), Part('"b"', (block(),), (1.2, 0.0, 0.0))]
    film_of_answer(answer(parts, [(0, 0, 0), (0, 0.3, 0)], (Pull('"b"', (0, 1)),), 0.3), tmp_path / "a.film.svg")
    assert "<script" not in (tmp_path / "a.film.svg").read_text()
