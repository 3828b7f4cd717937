"""Bad input of every kind: one plain line per finding, never another exception."""

from __future__ import annotations

import json

import pytest

from wiggleroom.assembly.build import assemble
from wiggleroom.drawing import read_drawing
from wiggleroom.errors import InputError

TRIANGLE = [[0, 0], [2, 0], [2, 1]]


def assembly(**changes: object) -> str:
    content: dict[str, object] = {
        "format": "wiggleroom/1",
        "parts": [
            {"name": "a", "outline": TRIANGLE, "fixed": True},
            {"name": "b", "outline": TRIANGLE, "at": [3, 0, 0]},
        ],
    }
    return json.dumps({**content, **changes})


def part(**changes: object) -> str:
    return assembly(parts=[{"name": "a", "outline": TRIANGLE, **changes}])


def svg(body: str, head: str = 'width="9mm" height="9mm" viewBox="0 0 9 9"') -> str:
    return f"<svg {head}>{body}</svg>"


SQUARE = '<rect id="a" width="4" height="4"/>'

JSON_CASES = {
    "truncated": (assembly()[:-9], "is not JSON"),
    "not a number": (assembly().replace("3,", "NaN,"), "is not JSON"),
    "infinite": (assembly().replace("3,", "1e999,"), "line 1"),
    "a list": ("[1, 2]", "one JSON object"),
    "deep": ("[" * 100_000, "nested too deep"),
    "no format": ('{"parts": []}', '"format" is missing'),
    "other format": (assembly(format="wiggleroom/9"), 'must be "wiggleroom/1" or "wiggleroom/2"'),
    "no parts": (assembly(parts=[]), "has no parts"),
    "parts of wrong type": (assembly(parts={"a": 1}), "parts must be a list"),
    "unknown field": (assembly(colour="red"), '"colour" is not known'),
    "field twice": (assembly(gap=0.1).replace('"gap"', '"gap": 0.2, "gap"'), 'x.json: field "gap" is given twice'),
    "field of a pull twice": (assembly(pull=[{"part": "b", "direction": [1, 0]}]).replace('"direction"',
        '"direction": [0, 1], "direction"'), 'part "b": field "direction" is given twice'),
    "unit": (assembly(unit="furlong"), "mm, cm, m, in"),
    "gap below zero": (assembly(gap=-0.1), "gap is -0.1"),
    "gap as text": (assembly(gap="0.1"), "gap must be a number"),
    "part is text": (assembly(parts=["a"]), "parts[0]: it must be an object"),
    "part without name": (assembly(parts=[{"outline": TRIANGLE}]), 'parts[0]: field "name" is missing'),
    "empty name": (part(name=""), "name must be printable"),
    "unprintable name": (part(name="a\nb"), "name must be printable"),
    "name that turns what follows": (part(name="a\u202eb"), "name must be printable"),
    "name of joiners": (part(name="\u200d\u200c"), "name must be printable"),
    "duplicate name": (assembly(parts=[{"name": "a", "outline": TRIANGLE}] * 2), "used 2 times"),
    "two corners": (part(outline=[[0, 0], [1, 0]]), 'part "a": outline has 2 corners; at least 3 are needed'),
    "on one line": (part(outline=[[0, 0], [1, 0], [2, 0]]), "all corners on one line"),
    "corner of three": (part(outline=[[0, 0, 0], [1, 0, 0], [1, 1, 0]]), "must be a list of 2, not of 3"),
    "no material": (assembly(parts=[{"name": "a"}]), "none of them"),
    "unknown shape": (assembly(parts=[{"name": "a", "shape": "s"}]), 'shape "s" is not among'),
    "shape of nothing": (assembly(shapes={"s": {}}), 'shape "s": must have either'),
    "empty outlines": (assembly(parts=[{"name": "a", "outlines": []}]), '"outlines" is empty'),
    "huge coordinates": (part(outline=[[0, 0], [1e12, 0], [1, 1]]), "beyond 1e+09 mm"),
    "far away": (part(at=[1e12, 0, 0]), "within 1e+09 mm"),
    "tiny": (part(outline=[[0, 0], [1e-9, 0], [0, 1e-9]]), "at least 1e-06 mm"),
    "at of two": (part(at=[0, 0]), "at must be [x, y, degrees], a list of 3, not of 2"),
    "fixed as number": (part(fixed=1), "fixed must be true or false"),
    "glue unknown": (assembly(glue=[["a", "z"]]), 'no part "z"'),
    "glue with itself": (assembly(glue=[["a", "a"]]), "two different parts"),
    "ignore of three": (assembly(ignore=[["a", "b", "a"]]), "list of 2, not of 3"),
    "gaps below zero": (assembly(gaps=[{"parts": ["a", "b"], "gap": -1}]), "gap is -1"),
    "gaps twice": (assembly(gaps=[{"parts": ["a", "b"], "gap": 1}, {"parts": ["b", "a"], "gap": 2}]), "given 2 times"),
    "pull a fixed part": (assembly(pull=[{"part": "a", "direction": [1, 0]}]), "is fixed"),
    "pull nowhere": (assembly(pull=[{"part": "b", "direction": [0, 0]}]), "direction is zero"),
    "pull and turn": (assembly(pull=[{"part": "b", "turn": "cw", "w": [1, 0, 0]}]), '"turn" or "w"'),
    "turn sideways": (assembly(pull=[{"part": "b", "turn": "left"}]), 'must be "ccw" or "cw"'),
    "unknown objective": (assembly(objective="energy"), 'objective is "energy"; it must be "translation" or "closer"'),
    "objective of a wrong kind": (assembly(objective=3), "objective must be text, not a number"),
    "objective besides pull": (assembly(objective="closer", pull=[{"part": "b", "turn": "ccw"}]),
        '"objective" stands in place of "pull"'),
}  # fmt: skip

SVG_CASES = {
    "truncated": (svg(SQUARE)[:-9], "not well-formed XML"),
    "not svg": ("<html><body/></html>", "outermost element must be svg"),
    "entity": ('<!DOCTYPE svg [<!ENTITY a "ha"><!ENTITY lol "&a;&a;">]>' + svg("<text>&lol;</text>"), 'entity "lol"'),
    "hidden entity": ('<!--a--><!DOCTYPE svg [<!ENTITY<!--b--> c "&d;">]>' + svg(SQUARE), 'entity "c"'),
    "nothing": (svg(""), "no closed outline"),
    "open only": (svg('<path d="M0 0L3 0L3 3"/>'), "but 1 open; every part must be closed"),
    "one point": (svg('<polygon points="1,1 1,1 1,1"/>'), "is 0 mm large"),
    "no size": (svg('<rect id="a" width="0" height="3"/>'), "no closed outline, only 1 element without size"),
    "width below zero": (svg('<rect width="-1" height="1"/>'), "must not be negative"),
    "bad number": (svg('<path d="M0 0L3 foo 3 3z"/>'), '"foo"'),
    "bad command": (svg('<path d="M0 0X5 5"/>'), '"X"'),
    "no move": (svg('<path d="L5 5z"/>'), "must begin with M"),
    "missing numbers": (svg('<path d="M0 0C"/>'), 'ends at "C"'),
    "arc flag": (svg('<path d="M0 0A1 1 0 2 0 5 5z"/>'), "only numbers"),
    "overflow": (svg('<path d="M0 0L1e999 0L0 1z"/>'), "beyond 1e+15"),
    "huge": (svg('<path d="M0 0L1e12 0L0 1e12z"/>'), "beyond 1e+09 mm"),
    "tiny": (svg(SQUARE, 'width="1e-9mm" viewBox="0 0 9 9"'), "at least 1e-06 mm"),
    "zero width": (svg(SQUARE, 'width="0mm" viewBox="0 0 9 9"'), "must be larger than 0"),
    "bad viewBox": (svg(SQUARE, 'width="9mm" viewBox="0 0 9"'), "four numbers"),
    "bad transform": (svg(f'<g transform="rotate(30">{SQUARE}</g>'), "transform cannot be read"),
    "unknown transform": (svg(f'<g transform="wobble(3)">{SQUARE}</g>'), '"wobble" is not known'),
    "transform of three": (svg(f'<g transform="matrix(1 0 0)">{SQUARE}</g>'), "6 finite numbers"),
    "flat transform": (svg(f'<g transform="scale(1,0)">{SQUARE}</g>'),
        'rect "a" (line 1): is scaled to a line or a point'),
    "transform out of range": (svg(f'<g transform="scale(1e300)">{SQUARE}</g>'),
        'rect "a" (line 1): is moved or scaled by more than'),
    "use of nothing": (svg('<use href="#nope"/>'), '"#nope"'),
    "use of a file": (svg('<use href="other.svg#a"/>'), "other.svg#a"),
    "use of itself": (svg('<g id="g"><use href="#g"/></g>'), "holds this use itself"),
    "copies of copies": (
        svg("".join(f'<g id="g{i}">' + f'<use href="#g{i + 1}"/>' * 10 + "</g>" for i in range(30)) + '<g id="g30"/>'),
        "draws more than 100000 elements",
    ),
    "deep groups": (svg("<g>" * 5000 + SQUARE + "</g>" * 5000), "nested deeper than 200"),
    "crossing subpaths": (svg('<path id="k" d="M0 0h4v4h-4zM2 2h4v4h-4z"/>'), "two outlines cross at ("),
    "bow tie with a hole": (svg('<path d="M0 0L4 4L4 0L0 4zM1 1h1v1h-1z"/>'), "crosses itself at (2, 7) mm"),
}  # fmt: skip


def findings_of(path, **options) -> tuple[str, ...]:
    with pytest.raises(InputError) as caught:
        read_drawing(path, **options)
    for finding in caught.value.findings:
        assert "\n" not in finding
        assert finding.strip()
    return caught.value.findings


def findings_if_any(path) -> tuple[str, ...]:
    try:
        read_drawing(path)
    except InputError as error:
        return error.findings
    return ()


@pytest.mark.parametrize("case", JSON_CASES)
def test_assembly(tmp_path, case):
    text, said = JSON_CASES[case]
    path = tmp_path / "x.json"
    path.write_text(text)
    findings = findings_of(path)
    assert said in findings[0]
    assert all(finding.startswith("x.json: ") for finding in findings)
    assert len(findings) == 1


@pytest.mark.parametrize(
    ("outline", "words"),
    [
        ([[0, 0], [4, 4], [4, 0], [0, 4]], "crosses itself at (2, 2)"),
        ([[0, 0], [4, 0], [1, 0], [3, 0]], "without area"),
    ],
)
@pytest.mark.parametrize("shared", [False, True])
def test_an_outline_that_encloses_nothing_is_named_by_its_part(tmp_path, outline, words, shared):
    path = tmp_path / "x.json"
    own = {"shape": "s"} if shared else {"outline": outline}
    made = {"parts": [{"name": "a", **own}]} | ({"shapes": {"s": {"outline": outline}}} if shared else {})
    path.write_text(assembly(**made))
    with pytest.raises(InputError) as caught:
        assemble(read_drawing(path))
    assert len(caught.value.findings) == 1
    assert 'part "a" ' in caught.value.findings[0]
    assert words in caught.value.findings[0]


@pytest.mark.parametrize("case", SVG_CASES)
def test_drawing(tmp_path, case):
    text, said = SVG_CASES[case]
    path = tmp_path / "x.svg"
    path.write_text(text)
    findings = findings_of(path)
    assert said in findings[0]
    assert all(finding.startswith("x.svg: ") for finding in findings)
    assert len(findings) <= (2 if "use" in case else 1)


RAW_CASES = {
    "empty": ("x.svg", b"", "is empty"),
    "png": ("x.svg", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "is not UTF-8 text at byte 0"),
    "zeros": ("x.json", bytes(100), "is binary"),
    "latin-1 undeclared": ("x.svg", svg("<g id='\u00e4'/>").encode("latin-1"), "is not UTF-8"),
    "odd utf-16": ("x.svg", b"\xff\xfe<\0s\0v", "is not UTF-16 text"),
    "unknown encoding": ("x.svg", b"<?xml version='1.0' encoding='klingon'?><svg/>", '"klingon" is not known'),
    "pdf": ("x.pdf", b"%PDF-1.7", "must be one of .svg, .dxf, .lbrn2"),
    "no extension": ("drawing", b"<svg/>", "files without extension"),
    "json called svg": ("x.svg", assembly().encode(), "not well-formed XML"),
}


@pytest.mark.parametrize("case", RAW_CASES)
def test_raw_bytes(tmp_path, case):
    name, raw, said = RAW_CASES[case]
    (tmp_path / name).write_bytes(raw)
    findings = findings_of(tmp_path / name)
    assert said in findings[0]
    assert len(findings) == 1


def test_places_without_a_file(tmp_path):
    assert "no such file" in findings_of(tmp_path / "missing.svg")[0]
    (tmp_path / "folder.svg").mkdir()
    assert "is a directory" in findings_of(tmp_path / "folder.svg")[0]
    assert "cannot be read" in findings_of("nul\0byte.svg")[0]
    assert "cannot be read" in findings_of("x" * 5000 + ".svg")[0]


@pytest.mark.parametrize(
    "text", [assembly(gap=0.2), svg(SQUARE), "// parts\n" + assembly()], ids=["json", "svg", "comment"]
)
def test_what_a_file_holds_is_not_its_name(text):
    assert findings_of(text) == (
        "what a file holds was given in place of its name: write it to a file, and give the name of that",
    )


@pytest.mark.parametrize("number", [1e308, -1e150, 1e-310])
def test_factors_out_of_range_are_refused(tmp_path, number):
    path = tmp_path / "x.json"
    for asked in ({"direction": [1, 0], "weight": number}, {"turn": "cw", "weight": number}, {"w": [1, number, 0]}):
        path.write_text(assembly(pull=[{"part": "b", **asked}]))
        with pytest.raises(InputError, match=r"x\.json: .* between 1e-100 and 1e\+100 in size") as caught:
            assemble(read_drawing(path))
        assert len(caught.value.findings) == 1


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"gap": -1.0}, "gap is -1"),
        ({"gap": float("nan")}, "gap is nan"),
        ({"flatten": 0.0}, "flatten is 0"),
        ({"flatten": float("inf")}, "flatten is inf"),
        ({"unit": "ell"}, "mm, cm, m, in, px"),
    ],
)
def test_options(tmp_path, options, said):
    path = tmp_path / "x.svg"
    path.write_text(svg(SQUARE))
    assert said in findings_of(path, **options)[0]


def test_unit_of_an_assembly_file(tmp_path):
    path = tmp_path / "x.json"
    path.write_text(assembly())
    assert "says its own unit" in findings_of(path, unit="mm")[0]


def test_all_findings_at_once(tmp_path):
    path = tmp_path / "x.json"
    parts = [
        {"name": "a", "outline": [[0, 0], [1, 0]]},
        {"name": "b", "outline": TRIANGLE, "at": [0, "x", 0]},
        {"name": "c", "shape": "none"},
        {"name": "c", "outline": TRIANGLE},
    ]
    path.write_text(assembly(parts=parts, gap=-1, unit="ell", glue=[["a", "z"]], pull=[{"part": "y", "turn": "cw"}]))
    findings = findings_of(path)
    assert len(findings) == 8
    for said in ("gap", "unit", 'part "a"', 'part "b"', 'part "c"', '"z"', '"y"', "2 times"):
        assert any(said in finding for finding in findings)


def test_all_findings_of_a_drawing_at_once(tmp_path):
    path = tmp_path / "x.svg"
    path.write_text(
        svg('<path id="p" d="M0 0z q"/><circle id="c" r="-1"/>' + SQUARE + SQUARE + '<rect id="r" width="-1"/>')
    )
    findings = findings_of(path)
    assert [next(n for n in ("p", "c", "r") if f'"{n}"' in finding) for finding in findings] == ["p", "c", "r"]


@pytest.mark.parametrize("seed", range(4))
def test_damaged_files(tmp_path, seed):
    """Bytes changed at random: read or refused, nothing else."""
    import random

    random.seed(seed)
    good = {
        "x.svg": svg(
            '<g id="glue1" style="fill:red"><path d="M0 0L4 0C4 1 5 2 4 4A2 3 20 0 1 0 4z"/>' + SQUARE + "</g>"
        ),
        "x.json": assembly(
            glue=[["a", "b"]], pull=[{"part": "b", "direction": [1, 0]}], shapes={"s": {"outline": TRIANGLE}}
        ),
    }
    for name, text in good.items():
        for _ in range(15):
            raw = bytearray(text.encode())
            for _ in range(random.randint(1, 4)):
                raw[random.randrange(len(raw))] = random.choice(b'0159-.eE"<>/,[]{}azMLCAZ \xff\0')
            (tmp_path / name).write_bytes(bytes(raw))
            findings = findings_if_any(tmp_path / name)
            assert all("\n" not in finding for finding in findings)
