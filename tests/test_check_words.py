"""What `check` says in words: about gaps as drawn, and about a search that was not needed."""

import wiggleroom as wr
from wiggleroom.disassembly.largest_gap import LargestGap
from wiggleroom.report.results.separability import border_sentence, check_sure

PLATE = [(-9, -9), (9, -9), (9, 9), (2, 9), (2, -4), (-2, -4), (-2, 9), (-9, 9)]
PEG = [(-1, -3), (1, -3), (1, 3), (-1, 3)]


def test_what_comes_apart_as_drawn_is_held_by_no_gap(tmp_path) -> None:
    text = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="-9 -9 18 18" width="18mm" height="18mm">'
    for name, outline in (("fixed", PLATE), ("peg", PEG)):
        text += f'<polygon id="{name}" points="' + " ".join(f"{x},{-y}" for x, y in outline) + '"/>'
    file = tmp_path / "open.svg"
    file.write_text(text + "</svg>")
    border = wr.largest_gap(wr.read(str(file)))
    assert border.holds is None
    assert border.parts_at == 0.0
    assert border_sentence(border) == "largest gap: no gap holds it together"


def test_no_search_is_not_counted() -> None:
    found = wr.check(wr.patterns.chain(2, joint="tee", gap=0.02))
    assert found.questions == 0
    assert check_sure(found)[-1] == ("took", f"{found.seconds:.2f} seconds, no largest motion searched")


def test_a_border_that_stays_wide_says_so() -> None:
    assert border_sentence(LargestGap(2.629, 2.63, None, None)).endswith("comes apart at 2.63 mm")
    assert border_sentence(LargestGap(2.629, 2.635, None, None)).endswith("; between them it was not decided")
