"""IPOPT in space: the same program in other variables, against closed forms and our own method."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import wiggleroom as wr
from wiggleroom.drawing.model import Turn
from wiggleroom.errors import InputError, MissingExtraError

pytest.importorskip("casadi")

PLATE = {
    "name": "plate",
    "outline": [[-20, -20], [20, -20], [20, 20], [-20, 20]],
    "holes": [[[-5.2, -5.2], [5.2, -5.2], [5.2, 5.2], [-5.2, 5.2]]],
    "thickness": 12,
    "at": [0, 0, -6],
    "fixed": True,
}
PEG = {"name": "peg", "boxes": [[-5, -5, -20, 5, 5, 20]]}


def read(tmp_path: Path, *parts: dict, **more: object):
    file = tmp_path / "made.json"
    file.write_text(json.dumps({"format": "wiggleroom/2", "parts": list(parts), **more}))
    return wr.read(file)


def test_a_square_peg_moves_as_closed_forms_say(tmp_path):
    assembly = read(tmp_path, PLATE, PEG | {"lock": ["rx", "ry"]})
    twist = brentq(lambda a: 10 * (np.cos(a) + np.sin(a)) - 10.4, 0, 0.5)
    turned = wr.flex(assembly, Turn("peg", (0, 0, 1)), solver="ipopt")
    assert turned.objective == pytest.approx(twist, abs=1e-7)
    assert (turned.verdict, turned.path, turned.solver) == ("optimal", "checked", "ipopt")
    assert wr.flex(assembly, wr.Pull("peg", (1, 0, 0)), solver="ipopt").objective == pytest.approx(0.2, abs=1e-7)


def test_a_tilting_peg_moves_as_our_own_method_says(tmp_path):
    assembly = read(tmp_path, PLATE, PEG)
    pulls = [wr.Pull("peg", (s, 0, 0), (0, 0, 20.0 * s)) for s in (1, -1)]
    ours, theirs = (wr.flex(assembly, pulls, solver=s) for s in ("interior-point", "ipopt"))
    assert theirs.objective == pytest.approx(ours.objective, rel=1e-7)
    assert theirs.collision_free
    assert sum(c.force for c in theirs.contacts) == pytest.approx(sum(c.force for c in ours.contacts), rel=1e-2)


def test_what_leaves_and_what_turns_without_limit_is_named(tmp_path):
    assembly = read(tmp_path, PLATE, PEG)
    assert wr.flex(assembly, wr.Pull("peg", (0, 0, 1)), solver="ipopt").leaves == ("peg",)
    pin = {"name": "pin", "boxes": [[-2, -2, -20, 2, 2, 20]]}
    assert wr.flex(read(tmp_path, PLATE, pin), Turn("pin", (0, 0, 1)), solver="ipopt").turns == ("pin",)


def test_a_solver_that_is_not_there_is_said(tmp_path, monkeypatch):
    assembly = read(tmp_path, PLATE, PEG)
    pull = wr.Pull("peg", (1, 0, 0))
    with pytest.raises(InputError, match='"simplex" is not known; solvers are interior-point, ipopt'):
        wr.flex(assembly, pull, solver="simplex")
    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(MissingExtraError, match=r"pip install '.\[ipopt\]'"):
        wr.flex(assembly, pull, solver="ipopt")
