"""Files as makers have them: read as their makers expect, with everything said that was assumed or left out."""

from __future__ import annotations

import time

import pytest

from tests.makers.by_hand import FINDINGS, LIGHTBURN, STYLES
from tests.makers.by_library import CASES
from tests.makers.case import Case
from wiggleroom.assembly.findings import examine
from wiggleroom.drawing.layers import ReadOptions
from wiggleroom.drawing.read import reading
from wiggleroom.errors import InputError

ALL = [*FINDINGS, *STYLES, *LIGHTBURN, *CASES]


@pytest.mark.parametrize("case", ALL, ids=[f"{case.program}: {case.name}" for case in ALL])
def test_read_as_the_maker_expects(case: Case, tmp_path):
    path = tmp_path / case.name
    path.write_bytes(case.data)
    options = dict(case.options)
    gap = options.pop("gap", None)
    begin = time.process_time()
    try:
        found = reading(path, gap=gap, options=ReadOptions(**options))
    except InputError as problem:
        assert case.refused, problem
        assert any(case.refused in line for line in problem.findings)
        return
    assert time.process_time() - begin < 1.0
    findings = [*found.findings, *(examine(found.drawing)[1] if found.drawing.parts else ())]
    if case.refused:
        assert any(case.refused in line for line in findings), findings
        return
    said = " ".join(found.drawing.notes)
    assert not findings, (findings, said)
    assert len(found.drawing.parts) == case.parts, said
    assert sum(len(r.holes) for part in found.drawing.parts for r in part.regions) == case.holes, said
    assert {part.name for part in found.drawing.parts} >= set(case.names)
    for words in case.noted:
        assert words in said
