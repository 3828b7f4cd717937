#!/usr/bin/env python3
"""Inkscape extension: asks wiggleroom about the open drawing and draws the answer on a layer of its own.

Everything is worked out by the command line; this hands it the drawing and reads its JSON.
"""

from __future__ import annotations

import json
import math
import shlex
import subprocess
import tempfile
from argparse import ArgumentParser
from copy import deepcopy
from pathlib import Path

import inkex

LAYER = "wiggleroom"
TURNS = ("ccw", "cw")
STYLE = {"fill": "none", "stroke": "#1f5f9e", "stroke-width": "0.3"}
PHYSICAL = ("mm", "cm", "in", "pt", "pc", "m", "q")


class Ask(inkex.EffectExtension):
    """One question about the drawing."""

    def add_arguments(self, pars: ArgumentParser) -> None:
        """Options of the dialog."""
        pars.add_argument("--tab")
        pars.add_argument("--ask", default="flex")
        pars.add_argument("--number", type=float, default=0.5)
        pars.add_argument("--gap", type=float, default=0.0)
        pars.add_argument("--towards", default="+x")
        pars.add_argument("--fix", default="")
        pars.add_argument("--program", default="wiggleroom")
        pars.add_argument("--time", type=float, default=60.0)

    def effect(self) -> None:
        """Ask, say the answer, and draw it."""
        with tempfile.TemporaryDirectory() as folder:
            drawing, moved = Path(folder) / "drawing.svg", Path(folder) / "moved.json"
            drawing.write_bytes(inkex.etree.tostring(self._without_answer()))
            words = self._question(drawing)
            if self.options.ask in ("flex", "check"):
                words += ["--moved", str(moved)]
            done = self._run([words[0], str(drawing), *words[1:], "--json", "-", "--time", f"{self.options.time:g}"])
            if not done.stdout.strip():
                raise inkex.AbortExtension(done.stderr.strip() or "wiggleroom gave no answer")
            answer = json.loads(done.stdout)
            said = [sentence(answer), *notes(done.stderr)]
            self._draw(json.loads(moved.read_text(encoding="utf-8")) if moved.exists() else None, said[0])
        inkex.errormsg("\n".join(said))

    def _without_answer(self) -> inkex.SvgDocumentElement:
        """The drawing without what an earlier question drew."""
        root = deepcopy(self.document.getroot())
        for layer in root.xpath(f"//svg:g[@inkscape:label='{LAYER}']"):
            layer.getparent().remove(layer)
        return root

    def _question(self, drawing: Path) -> list[str]:
        """Words of the command after the drawing, the command's name first."""
        options = self.options
        fix = ["--fix", options.fix] if options.fix.strip() else []
        if options.ask == "check":
            return ["check", "--gap", f"{options.gap:g}", *fix]
        if options.ask == "holds":
            return ["gap", "--holds", *fix]
        if options.ask == "fits":
            return ["gap", "--fits", f"{options.number:g}", *fix]
        pulled = self._selected(drawing)
        way = ["--turn" if options.towards in TURNS else "--pull", f"{pulled}:{options.towards}"]
        if options.ask == "gap":
            return ["gap", "--at-most", f"{options.number:g}", "--gap", f"{options.gap:g}", *fix, *way]
        return ["flex", "--gap", f"{options.gap:g}", *fix, *way]

    def _selected(self, drawing: Path) -> str:
        """Name of the part that is selected, as wiggleroom reads it."""
        element = next(iter(self.svg.selection), None)
        if element is None:
            raise inkex.AbortExtension("Select the part that is pulled first.")
        place = drawing.with_name("parts.json")
        done = self._run(["convert", str(drawing), str(place), "--gap", f"{self.options.gap:g}"])
        if not place.exists():
            raise inkex.AbortExtension(done.stderr.strip() or "wiggleroom cannot read this drawing")
        names = {part["name"] for part in json.loads(place.read_text(encoding="utf-8"))["parts"]}
        for one in (element, *element.ancestors(), *element.descendants()):
            for name in (one.get("inkscape:label"), one.get("id")):
                if name in names:
                    return name
        msg = f"The selected object is none of the parts: {', '.join(sorted(names))}"
        raise inkex.AbortExtension(msg)

    def _run(self, words: list[str]) -> subprocess.CompletedProcess[str]:
        """Run the command line."""
        try:
            return subprocess.run(
                [*shlex.split(self.options.program), *words],
                capture_output=True,
                text=True,
                encoding="utf-8",
                check=False,
            )
        except OSError as problem:
            wrong = f"{self.options.program}: {problem.strerror}. Install it with pip, or name it on the page Program."
            raise inkex.AbortExtension(wrong) from problem

    def _draw(self, assembly: dict | None, title: str) -> None:
        """Put the moved outlines on the layer of the answer, in place of an earlier one."""
        for layer in self.svg.xpath(f"//svg:g[@inkscape:label='{LAYER}']"):
            layer.getparent().remove(layer)
        if assembly is None:
            return
        layer = self.svg.add(inkex.Layer.new(LAYER))
        layer.add(inkex.Title.new(title))
        left, bottom, scale = page(self.svg)
        for data in paths(assembly, left, bottom, scale):
            element = layer.add(inkex.PathElement())
            element.set("d", data)
            element.style = inkex.Style(STYLE | {"stroke-width": f"{0.3 * scale:g}"})


def page(svg: inkex.SvgDocumentElement) -> tuple[float, float, float]:
    """Left and bottom of the page in user units, and user units per millimetre, as wiggleroom takes them."""
    x, y, width, height = svg.get_viewbox()
    scales = []
    for side, length in (("width", width), ("height", height)):
        size = str(svg.get(side) or "").strip().lower()
        if size.endswith(PHYSICAL):
            scales.append((length or 0.0) / inkex.units.convert_unit(size, "mm"))
    if not height:  # no viewBox: user units are pixels
        height = inkex.units.convert_unit(str(svg.get("height") or "0"), "px")
        scales = [inkex.units.convert_unit("1mm", "px")] if scales else []
    return x, y + height, max(scales, default=1.0)


def paths(assembly: dict, left: float, bottom: float, scale: float) -> list[str]:
    """Path data of every part of an assembly file, on the page."""
    shapes, found = assembly.get("shapes", {}), []
    for part in assembly["parts"]:
        material = shapes[part["shape"]] if "shape" in part else part
        pieces = material.get("outlines") or [material]
        x, y, angle = part.get("at", (0.0, 0.0, 0.0))
        cosine, sine = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        data = []
        for ring in [ring for piece in pieces for ring in (piece["outline"], *piece.get("holes", []))]:
            corners = [
                (left + scale * (x + cosine * u - sine * v), bottom - scale * (y + sine * u + cosine * v))
                for u, v in ring
            ]
            data.append("M " + " L ".join(f"{u:.6f},{v:.6f}" for u, v in corners) + " Z")
        found.append(" ".join(data))
    return found


def sentence(answer: dict) -> str:
    """The answer in one line."""
    kind = answer["format"].partition("/")[0].rpartition(".")[2]
    if kind == "check":
        return f"{answer['verdict']} ({answer['certainty']})"
    if kind == "gap":
        if answer["gap"] is None:
            return f"no gap: {answer['note']}"
        which = "smallest" if answer["question"] == "fits" else "largest"
        return f"{which} gap {answer['gap']:.4g} mm ({answer['certainty']})"
    if answer["objective"] is None:
        return "nothing stops it: " + ", ".join(answer["leaves"] + answer["turns"])
    return f"it moves {answer['objective']:.4g} mm or rad ({answer['verdict']})"


def notes(text: str) -> list[str]:
    """What was assumed: lines of stderr but those that name files."""
    return [line for line in text.splitlines() if line and not line.startswith("moved parts: ")]


if __name__ == "__main__":
    Ask().run()
