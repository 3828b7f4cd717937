"""A certificate that flex wrote verifies against the drawing, with the same options; with others it does not."""

from __future__ import annotations

from pathlib import Path

import pytest

SLIDER = Path(__file__).parents[1] / "examples" / "13_slider" / "slider.dxf"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "others"),
    [
        (["--turn", "b3:ccw"], ["--turn", "b3:cw"]),
        (["--glue", "b2,b3", "--pull", "b3:+y"], ["--pull", "b3:+y"]),
        (["--pull", "b3:+y", "--pull", "b2:+x"], ["--pull", "b3:+y"]),
        (["--pull", "b3:+y", "--turn", "b2:cw"], ["--pull", "b3:+y", "--turn", "b2:ccw"]),
    ],
)
def test_of_a_chain(options, others, tmp_path, command, capsys):
    chain, proof = tmp_path / "chain.json", tmp_path / "proof.json"
    assert command("make", "chain", 3, "--joint", "swallowtail", "--gap", 0.02, "-o", chain) == 0
    assert command("flex", chain, *options, "--prove", 0.02, "--certificate", proof) == 0
    capsys.readouterr()
    assert command("verify", proof, chain, *options) == 0
    assert capsys.readouterr().out.startswith("verified: ")
    assert command("verify", proof, chain, *others) == 1
    assert capsys.readouterr().out.startswith("not verified: ")


def test_of_a_dxf_drawing(tmp_path, command, capsys):
    proof = tmp_path / "proof.json"
    options = ["--gap", 0.2, "--pull", "slider:+x"]
    assert command("flex", SLIDER, *options, "--prove", 0.02, "--certificate", proof) == 0
    capsys.readouterr()
    assert command("verify", proof, SLIDER, *options) == 0
    assert "13.05" in capsys.readouterr().out
    assert command("verify", proof, SLIDER, "--gap", 0.3, "--pull", "slider:+x") == 1
