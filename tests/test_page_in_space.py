"""The page with an assembly in space, in a real browser against the real server."""

from __future__ import annotations

import base64
import io
import json
import re
import struct
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import wiggleroom as wr
from tests.app_client import TOKEN, Served
from tests.browser_page import Late, answered, following, visiting
from tests.page_waits import LATER, faded, plays, settled, until
from wiggleroom.app.open_requests import opened
from wiggleroom.cli.options import QuestionOptions
from wiggleroom.cli.serve_command import FirstRequest
from wiggleroom.report.page.solid_page import page_of_spatial_answer
from wiggleroom.schema.requests import OpenRequest

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[1] / "examples"
LID = {
    "format": "wiggleroom/2",
    "gap": 0.4,
    "parts": [
        {
            "name": "case",
            "outline": [[0, 0], [60, 0], [60, 40], [0, 40]],
            "holes": [[[10, 10], [50, 10], [50, 30], [10, 30]]],
            "thickness": 20,
            "fixed": True,
        },
        {"name": "block", "boxes": [[10, 10, 0, 50, 30, 36]], "lock": ["rx", "ry"]},
    ],
    "pull": [{"part": "block", "direction": [1, 0, 0]}],
}
"""A block that stands out of a frame of its size: with a gap g it moves by g in x and in y, and nothing stops it in z."""


@pytest.fixture(scope="module")
def lid(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    path = tmp_path_factory.mktemp("lid") / "lid.json"
    path.write_text(json.dumps(LID))
    with following(path) as one:
        yield one


def middle(page: Any) -> tuple[float, float]:
    box = page.locator(".stage canvas").bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def picture(page: Any) -> bytes:
    return settled(page, lambda: page.locator(".stage").screenshot())


def reached(page: Any) -> str:
    """What the headline says when a drag has come to its end."""
    page.locator("#answer", has_text=re.compile("moved")).wait_for()
    return settled(page, lambda: str(page.locator("#answer").inner_text()))


def saved(page: Any, words: str) -> bytes:
    page.get_by_role("button", name="Save", exact=True).click()
    with page.expect_download() as download:
        page.get_by_role("menuitem", name=words).first.click()
    return Path(download.value.path()).read_bytes()


def test_it_opens_answers_and_turns_by_mouse_and_keys(browser: Any, lid: Served) -> None:
    with visiting(browser, lid) as page:
        answered(page, "block moves 0.4 mm in +x")
        assert "no overlap, path from rest checked" in page.locator(".facts").first.inner_text()
        before = picture(page)
        x, y = middle(page)
        page.mouse.move(x - 350, y + 200)
        page.mouse.down()
        page.mouse.move(x - 250, y + 160, steps=4)
        page.mouse.up()
        turned = picture(page)
        assert turned != before
        page.locator(".stage canvas").focus()
        page.keyboard.press("ArrowLeft")
        assert picture(page) != turned
        page.keyboard.press("0")
        assert "aria-label" in page.locator(".stage canvas").evaluate("c => c.getAttributeNames()")
        answered(page, "block moves 0.4 mm in +x")  # looking changes no answer
        page.wait_for_timeout(1500)  # what is asked once an answer has settled
        assert page.locator(".findings").count() == 0


def test_a_dragged_part_stops_where_the_closed_form_says(browser: Any, lid: Served) -> None:
    with visiting(browser, lid) as page:
        answered(page, "block moves 0.4 mm in +x")
        x, y = middle(page)
        y -= 100  # on the block
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + 160, y + 90, steps=8)
        said = reached(page)
        line = page.locator(".facts").first.inner_text()
        page.mouse.up()
        assert "held by case" in line
        moved = float(re.search(r"moved ([\d.]+) mm", said).group(1))  # type: ignore[union-attr]
        assert 0.3 < moved < 60  # it may also have risen out of the frame
        assert page.locator(".selection .name").inner_text() == "block"
        page.keyboard.press("Escape")
        answered(page, "block moves 0.4 mm in +x")


def test_gap_pull_twist_fix_and_extra_gap_by_hand(browser: Any, lid: Served) -> None:
    with visiting(browser, lid) as page:
        answered(page, "block moves 0.4 mm in +x")
        page.get_by_label("gap, mm", exact=True).fill("0.8")
        page.keyboard.press("Enter")
        answered(page, "block moves 0.8 mm in +x")
        page.get_by_label("axis for block").select_option("-y")
        answered(page, "block moves 0.8 mm in -y")
        page.keyboard.press(".")
        page.locator(".stage canvas").focus()
        page.keyboard.press(".")
        page.get_by_label("what is asked of block").select_option("twist")
        answered(page, "block turns")
        page.get_by_label("axis for block").select_option("+z")
        page.get_by_label("what is asked of block").select_option("pull")
        answered(page, "nothing stops block in +z")
        page.get_by_label("axis for block").select_option("other")
        for axis, value in (("x", "0.6"), ("y", "0"), ("z", "0")):
            box = page.get_by_label(f"{axis} of the direction for block")
            if box.count():
                box.fill(value)
                page.keyboard.press("Enter")
        answered(page, "block moves 0.8 mm in +x")
        page.keyboard.press("Control+z")


def test_the_second_button_opens_what_can_be_done_and_still_moves_the_view(browser: Any, lid: Served) -> None:
    with visiting(browser, lid) as page:
        answered(page, "block moves")
        x, y = settled(page, lambda: middle(page))
        page.mouse.move(x, y)
        page.mouse.down(button="right")
        page.mouse.move(x + 40, y, steps=5)
        page.mouse.up(button="right")
        assert page.get_by_role("menu").count() == 0
        page.mouse.move(x, y)
        page.mouse.click(x + 40, y, button="right")
        menu = page.get_by_role("menu")
        menu.get_by_role("menuitem", name="See past it").wait_for()
        part = menu.get_attribute("aria-label")
        menu.get_by_role("menuitem", name="Twist").click()
        asked = page.get_by_label(f"what is asked of {part}")
        until(page, lambda: asked.count() > 0 and asked.input_value() == "twist", "it is not twisted")
        page.keyboard.press("w")
        page.locator("#answer").filter(has_text="Wiggle, freedom 1").wait_for()


def test_a_contact_that_is_pressed_chooses_its_joint(browser: Any, lid: Served) -> None:
    with visiting(browser, lid) as page:
        answered(page, "block moves 0.4 mm")
        page.locator("table.sorts tbody tr").first.wait_for()
        box = settled(page, lambda: page.locator(".stage canvas").bounding_box())
        seen = np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(int)
        red, green, blue = np.moveaxis(seen, 2, 0)  # arrows of forces and their feet are orange
        rows, columns = np.nonzero((red > 150) & (red - blue > 110) & (np.abs(green - 105) < 25))
        inside = (columns < box["x"] + box["width"]) & (rows > box["y"]) & (rows < box["y"] + box["height"])
        spots = list(zip(columns[inside][::9], rows[inside][::9], strict=True))
        slider = page.get_by_role("slider", name=re.compile("^gap between (block and case|case and block)"))

        def pressed() -> bool:
            page.mouse.click(*map(int, spots.pop()))
            return slider.count() > 0

        until(page, pressed, "no arrow leads to its joint")


def test_check_plays_the_way_out_and_the_largest_gap_is_said(browser: Any, lid: Served) -> None:
    with visiting(browser, lid) as page:
        answered(page, "block moves 0.4 mm in +x")
        page.get_by_role("tab", name="Come apart").click()
        page.get_by_role("button", name="Check", exact=True).click()
        page.locator(".verdict").wait_for()
        assert page.locator(".verdict").inner_text().lower() == "comes apart"
        assert page.locator("#answer").inner_text().startswith("block leaves straight in")
        plays(page)
        page.get_by_role("button", name="Find it").click()
        page.locator(".strong", has_text="largest gap").wait_for()
        assert "no gap holds it together" in page.locator(".strong", has_text="largest gap").inner_text()


def test_a_plan_with_gravity_is_played_step_by_step(browser: Any, lid: Served) -> None:
    with visiting(browser, lid) as page:
        answered(page, "block moves 0.4 mm in +x")
        page.get_by_role("tab", name="Come apart").click()
        page.get_by_label("direction in which loose parts fall").select_option("in -z")
        page.get_by_role("button", name="Plan", exact=True).click()
        page.locator(".verdict", has_text="taken apart").wait_for()
        page.locator("#tabpanel", has_text="--gravity=0,0,-1").wait_for()
        plays(page)


def test_a_voxel_puzzle_is_opened_by_hand_and_taken_apart(browser: Any, lid: Served, tmp_path: Path) -> None:
    file = tmp_path / "corner.puz"
    file.write_text("2 2 1\n1 1\n1 2\n")
    with visiting(browser, lid) as page:
        late = Late(page, set())
        page.goto(f"http://127.0.0.1:{lid.port}/?token={TOKEN}")
        answered(page, "block moves 0.4 mm in +x")
        page.get_by_role("tab", name="Come apart").click()
        plan = page.get_by_role("button", name="Plan", exact=True)
        assert plan.is_enabled()
        late.kinds = {"opened"}
        page.locator("#file").set_input_files(file)
        page.locator(".drop", has_text="Opening corner.puz").wait_for()
        assert plan.is_disabled()  # it would be of the file before
        until(page, lambda: len(late.held) > 0, "the file was not read")
        late.go()
        page.locator(".topbar", has_text="corner.puz").wait_for()
        page.locator(".findings").wait_for()  # nothing is fixed yet, and the page goes to that
        page.get_by_role("tab", name="Come apart").click()
        plan.click()
        page.locator(".verdict", has_text="taken apart in 1 move").wait_for()


def test_the_exploded_view_and_seeing_past_a_part_change_the_picture_alone(browser: Any, lid: Served) -> None:
    with visiting(browser, lid) as page:
        answered(page, "block moves 0.4 mm in +x")
        whole = picture(page)
        page.get_by_label("exploded view").fill("1")
        assert picture(page) != whole
        page.get_by_label("exploded view").fill("0")
        page.locator(".stage canvas").focus()
        page.keyboard.press(".")  # chooses the first part
        chosen = picture(page)
        page.keyboard.press("h")
        assert picture(page) != chosen
        answered(page, "block moves 0.4 mm in +x")


def test_the_view_along_an_axis_and_from_its_other_side(browser: Any, lid: Served) -> None:
    def side() -> list[float]:
        """Direction of the eye from the middle of all parts."""
        canvas = page.locator(".stage canvas")
        eye = np.array(settled(page, lambda: json.loads(canvas.get_attribute("data-eye"))))
        found: list[float] = (eye / np.linalg.norm(eye)).tolist()
        return found

    with visiting(browser, lid) as page:
        answered(page, "block moves 0.4 mm in +x")
        for axis, name in enumerate("xyz"):
            there = np.eye(3)[axis]
            page.keyboard.press(name)
            assert side() == pytest.approx(there, abs=0.2)  # the middle of the picture is not quite that of the parts
            page.locator(".axes circle").nth(axis).click()
            assert side() == pytest.approx(-there, abs=0.2)
        page.keyboard.press("ArrowUp")
        assert side()[2] > -0.999


def test_a_cut_shows_what_is_inside_and_lets_it_be_pressed(browser: Any, tmp_path: Path) -> None:
    walls = [[0, 0, 0, 40, 30, 1], [0, 0, 29, 40, 30, 30], [0, 0, 1, 1, 30, 29], [39, 0, 1, 40, 30, 29]]
    walls += [[1, 0, 1, 39, 1, 29], [1, 29, 1, 39, 30, 29]]
    shell = {"name": "shell", "boxes": walls, "fixed": True}
    path = tmp_path / "closed.json"
    parts = [shell, {"name": "core", "boxes": [[5, 5, 5, 35, 25, 25]]}]
    path.write_text(json.dumps({"format": "wiggleroom/2", "parts": parts}))
    with following(path) as served, visiting(browser, served) as page:
        page.locator("#answer[data-settled=true]").wait_for()
        closed = picture(page)

        def pressed() -> str:
            page.mouse.click(*middle(page))
            name: str = settled(page, lambda: page.locator(".selection .name").inner_text())
            return name

        assert pressed() == "shell"
        for axis in "xyz":
            page.get_by_label("cut across an axis").select_option(axis)
            assert pressed() == "core"
            page.get_by_label("place of the cut").fill("0")  # or all of it, where the eye is beyond
            assert picture(page) != closed
            page.get_by_label("place of the cut").fill("0.5")
        page.get_by_label("cut across an axis").select_option("none")
        assert pressed() == "shell"


def test_a_part_is_dragged_by_keys_and_goes_back(browser: Any, lid: Served) -> None:
    with visiting(browser, lid) as page:
        answered(page, "block moves 0.4 mm in +x")
        page.locator(".stage canvas").focus()
        page.keyboard.press(".")
        page.keyboard.press(".")
        assert page.locator(".selection .name").inner_text() == "block"
        for _ in range(3):
            page.keyboard.press("Shift+ArrowUp")
        assert "block moved" in reached(page)
        page.keyboard.press("Escape")
        answered(page, "block moves 0.4 mm in +x")


def test_what_is_saved_is_what_is_seen(browser: Any, lid: Served, tmp_path: Path) -> None:
    with visiting(browser, lid) as page:
        answered(page, "block moves 0.4 mm in +x")
        page.get_by_label("gap, mm", exact=True).fill("0.6")
        page.keyboard.press("Enter")
        answered(page, "block moves 0.6 mm in +x")
        (tmp_path / "design.json").write_bytes(saved(page, "Assembly file"))
        assert wr.flex(wr.read(tmp_path / "design.json")).objective == pytest.approx(0.6, abs=1e-6)
        assert struct.unpack("<4s", saved(page, "Model of the moved parts")[:4]) == (b"glTF",)
        assert json.loads(saved(page, "Answer in numbers"))["dimension"] == 3
        assert b"<svg" in saved(page, "Picture")


def test_an_upload_opens_no_other_file_and_says_so_in_one_line(browser: Any, lid: Served, tmp_path: Path) -> None:
    (tmp_path / "pin.stl").write_text("solid pin\nendsolid pin\n")
    parts = [{"name": "pin", "mesh": "pin.stl"}, {"name": "lid", "outline": "sheet.svg#lid", "thickness": 3}]
    (tmp_path / "named.json").write_text(json.dumps({"format": "wiggleroom/2", "parts": parts}))
    with visiting(browser, lid) as page:
        answered(page, "block moves 0.4 mm in +x")
        page.locator("#file").set_input_files(tmp_path / "named.json")
        page.locator(".findings li").nth(1).wait_for()
        lines = page.locator(".findings li").all_inner_texts()
        assert len(lines) == 2
        assert all("names another file, which is not opened" in line for line in lines)
        answered(page, "block moves 0.4 mm in +x")  # what was open stays
        (tmp_path / "own.json").write_text(json.dumps(LID | {"gap": 0.2}))
        page.locator("#file").set_input_files(tmp_path / "own.json")
        answered(page, "block moves 0.2 mm in +x")


def test_a_file_that_names_meshes_opens_from_the_command_line(browser: Any) -> None:
    path = EXAMPLES / "45_tetrahedra" / "plate.json"
    served = Served(FirstRequest(str(path), QuestionOptions(pull=("t3-3:+z",))))
    try:
        with visiting(browser, served) as page:
            answered(page, "t3-3 moves 0.3519 mm in +z")
    finally:
        served.close()


def test_a_page_cannot_send_files_beside_a_drawing(lid: Served) -> None:
    with lid.visit() as page:
        text = base64.b64encode(json.dumps(LID).encode()).decode()
        number = page.send("open", name="a.json", data=text, beside={"../x.stl": ""})
        said = page.until(number, "failed")
        assert "command line only" in said["findings"][0]


def test_long_work_in_space_stops_within_a_second(lid: Served) -> None:
    text = (EXAMPLES / "44_six_piece_burr" / "burr.json").read_bytes()
    with lid.visit() as page:
        page.until(page.send("open", name="burr.json", data=base64.b64encode(text).decode()), "opened")
        page.design = {"fixed": ["stick1"], "goals": [{"part": "stick2", "direction": [1, 0, 0]}]}
        page.ask("flex")  # kernels are there
        for kind, more in (("check", {}), ("limit", {}), ("sample", {"spread": 0.01, "draws": 2000})):
            page.send(kind, **more)
            time.sleep(0.5)
            began = time.perf_counter()
            page.send("cancel", of=kind)
            page.until(page.send("bound"), "failed")  # for drawings only; heard once the work before has stopped
            assert time.perf_counter() - began < 20  # one second on an idle machine; the whole work takes minutes


def test_freedoms_and_plans_in_space_are_told_with_their_frames(lid: Served) -> None:
    with lid.visit() as page:
        text = json.dumps(LID).encode()
        page.until(page.send("open", name="lid.json", data=base64.b64encode(text).decode()), "opened")
        modes = page.until(page.send("wiggle", part="block"), "modes")
        assert modes["modes"]
        assert all("block" in mode["parts"] for mode in modes["modes"])
        plan = page.until(page.send("plan", gravity=[0, 0, -1]), "plan")
        assert plan["words"]
        assert "--gravity=0,0,-1" in plan["command"]
        saved = page.until(page.send("save", what="json", of="plan"), "saved")
        assert json.loads(base64.b64decode(saved["data"]))["dimension"] == 3


def test_a_bound_is_proven_in_space_and_stays_with_the_answer(lid: Served) -> None:
    pytest.importorskip("highspy")
    with lid.visit() as page:
        case, block = LID["parts"]
        text = json.dumps(LID | {"parts": [case, block | {"lock": ["z", "rx"]}]}).encode()  # it could leave upwards
        page.until(page.send("open", name="lid.json", data=base64.b64encode(text).decode()), "opened")
        page.design = {"fixed": ["case"], "goals": [{"part": "block", "direction": [1, 0, 0]}]}
        found = page.ask("flex")
        reply = page.ask("prove", share=0.05, seconds=60)
        assert found["objective"] <= reply["at_most"] <= 1.05 * found["objective"]
        assert "proven" in reply["words"]
        assert "--prove 0.05" in reply["command"]


def test_questions_of_drawings_are_refused_in_space_in_one_line(lid: Served) -> None:
    with lid.visit() as page:
        page.until(
            page.send("open", name="lid.json", data=base64.b64encode(json.dumps(LID).encode()).decode()), "opened"
        )
        asked = [("reach", {"part": "block", "grip": [0, 0]}), ("bound", {})]
        asked += [("space", {"a": "case", "b": "block"}), ("save", {"what": "cut-svg"})]
        asked += [("drag", {"part": "block", "grip": [0, 0], "target": [1, 0]})]
        for kind, more in asked:
            said = page.until(page.send(kind, **more), "failed")
            assert said["kind"] == "failed"
            assert len(said["findings"]) == 1
            assert "fault in wiggleroom" not in said["findings"][0]
        page.design = {"fixed": ["case"], "goals": [{"part": "block", "direction": [1, 0, 0]}], "extra": {"block": 0.2}}
        wider = page.ask("flex")
        assert wider["objective"] == pytest.approx(0.5, abs=1e-6)  # half of it on either side
        assert wider["command"] == ""  # no command says that
        assert "cannot be written" in page.until(page.send("save", what="assembly"), "failed")["findings"][0]
        page.design = {"fixed": ["case"], "goals": [{"part": "block", "turn": "cw"}]}
        assert "three numbers" in page.until(page.send("flex"), "failed")["findings"][0]


def test_axe_finds_nothing_in_light_dark_and_on_a_phone(browser: Any, lid: Served) -> None:
    axe = Path(__file__).parents[1] / "web" / "node_modules" / "axe-core" / "axe.min.js"
    if not axe.is_file():
        pytest.skip("axe-core comes with the page's own packages: cd web && npm ci")
    for width, height, scheme in ((1280, 720, "light"), (1440, 900, "dark"), (390, 844, "light")):
        with visiting(browser, lid, bypass_csp=True, color_scheme=scheme) as page:
            page.set_viewport_size({"width": width, "height": height})
            answered(page, "block moves 0.4 mm in +x")
            page.locator(".stage canvas").focus()
            page.keyboard.press(".")
            faded(page)
            page.evaluate(axe.read_text())
            assert page.evaluate("axe.run().then(r => r.violations.map(v => v.id))") == []
            assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_the_samples_in_space_open(browser: Any) -> None:
    served = Served(None)
    try:
        with visiting(browser, served) as page:
            page.locator(".sample", has_text="burr").click()
            answered(page, "stick3")
            page.locator(".stage canvas").focus()
            for _ in range(3):
                page.keyboard.press(".")
            page.keyboard.press("Shift+ArrowRight")
            page.locator(".who .note", has_text="centre").wait_for()
            who, fix = (page.locator(one).bounding_box() for one in (".who", ".selection .button >> nth=0"))
            assert who["x"] + who["width"] <= fix["x"]
            page.reload()
            answered(page, "stick3")
    finally:
        served.close()


def test_a_file_in_space_is_known_in_any_encoding() -> None:
    for encoding in ("utf-8", "utf-16"):
        file = opened(OpenRequest(id=1, name="lid.json", data=json.dumps(LID).encode(encoding)))
        assert file.drawing.dimension == 3


def test_a_report_of_what_leaves_has_nothing_to_complain_of(browser: Any, tmp_path: Path) -> None:
    (tmp_path / "lid.json").write_text(json.dumps(LID))
    answer = wr.flex(wr.read(tmp_path / "lid.json"), wr.Pull("block", (0, 0, 1)))
    assert answer.leaves == ("block",)
    assert not answer.contacts
    report = tmp_path / "report.html"
    report.write_text(page_of_spatial_answer(answer, "wiggleroom flex lid.json"), encoding="utf-8")
    page = browser.new_page()
    wrong: list[str] = []
    page.on("console", lambda said: wrong.append(said.text) if said.type == "error" else None)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.goto(report.as_uri())
    page.locator("#view canvas").wait_for()
    page.locator("#explode").fill("1")
    page.evaluate(LATER)
    page.close()
    assert wrong == []


def margins(page: Any) -> tuple[float, float]:
    """Shares of the canvas that are left free round what is seen: the least and the greater of both directions' means."""
    image = np.asarray(Image.open(io.BytesIO(picture(page))).convert("L")).astype(int)[
        8:-8, 8:-8
    ]  # without the ring of the focus
    seen = abs(image - image[-3, -3]) > 6
    rows, columns = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    free = [(at[0] / n, 1 - (at[-1] + 1) / n) for at, n in ((rows, len(image)), (columns, len(image[0])))]
    return min(min(pair) for pair in free), min(sum(pair) / 2 for pair in free)


@pytest.mark.parametrize("size", [(400, 6, 6), (6, 6, 400), (60, 60, 1)])
def test_all_is_in_the_picture_and_fills_it_from_every_side(
    browser: Any, tmp_path: Path, size: tuple[float, float, float]
) -> None:
    x, y, z = size
    design = LID | {
        "parts": [
            {
                "name": "case",
                "outline": [[0, 0], [x, 0], [x, y], [0, y]],
                "holes": [[[2, 2], [x - 2, 2], [x - 2, y - 2], [2, y - 2]]],
                "thickness": z,
                "fixed": True,
            },
            {"name": "block", "boxes": [[2, 2, 0, x - 2, y - 2, z]], "lock": ["rx", "ry", "rz"]},
        ]
    }
    (tmp_path / "bar.json").write_text(json.dumps(design))
    with following(tmp_path / "bar.json") as one, visiting(browser, one) as page:
        answered(page, "block moves 0.4 mm in +x")
        page.locator(".axes").evaluate("one => one.remove()")
        assert_filled(page)
        page.get_by_label("exploded view").fill("1.5")
        assert_filled(page)
        page.locator(".stage canvas").focus()
        for _ in range(4):
            page.keyboard.press("ArrowLeft")
        page.keyboard.press("0")
        assert_filled(page)
        page.get_by_label("exploded view").fill("0")
        page.set_viewport_size({"width": 390, "height": 844})
        assert_filled(page)


def assert_filled(page: Any) -> None:
    least, mean = margins(page)
    assert 0 < least <= mean < 0.12
