"""Save: what is on screen as a file, made by the same writers as the commands' and handed over as bytes."""

from __future__ import annotations

import base64
import shlex
import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wiggleroom.app.command import command
from wiggleroom.app.open_requests import saved_name, temporary_file
from wiggleroom.app.reporter import Reporter
from wiggleroom.assembly.kerf import compensated
from wiggleroom.drawing import write_drawing, write_in_place
from wiggleroom.errors import InputError
from wiggleroom.report.page.pages import page_of_answer
from wiggleroom.report.results.json_results import flex_result, to_json
from wiggleroom.report.results.separability import Checked, check_result
from wiggleroom.report.write_picture import write_picture
from wiggleroom.schema.replies import Saved
from wiggleroom.schema.requests import SaveRequest
from wiggleroom.verdict import SearchState

if TYPE_CHECKING:
    from msgspec import Struct

    from wiggleroom.app.document import Document
    from wiggleroom.planning.plan import Plan

FILE_KINDS = {
    "svg": ("-moved.svg", "image/svg+xml"),
    "png": ("-moved.png", "image/png"),
    "gif": ("-moved.gif", "image/gif"),
    "mp4": ("-moved.mp4", "video/mp4"),
    "glb": ("-moved.glb", "model/gltf-binary"),
    "html": ("-report.html", "text/html"),
    "json": (".answer.json", "application/json"),
    "stills": ("-steps.zip", "application/zip"),
    "assembly": ("-design.json", "application/json"),
    "cut-svg": ("-cut.svg", "image/svg+xml"),
    "cut-dxf": ("-cut.dxf", "image/vnd.dxf"),
    "cut-lbrn2": ("-cut.lbrn2", "application/xml"),
    "cut-lbrn": ("-cut.lbrn", "application/xml"),
}
"""What is added to the drawing's name, and what the browser is told it is."""


_SAVED_AS = {"flex": "-moved", "check": "-apart", "plan": "-plan"}


def save(document: Document, request: SaveRequest, out: Reporter) -> None:
    """One file, by name, kind and content."""
    tail, mime = FILE_KINDS[request.what]
    name = saved_name(document.file.name, tail.replace("-moved", _SAVED_AS[request.of]))
    with tempfile.TemporaryDirectory(prefix="wiggleroom-") as folder:
        path = Path(folder) / name
        _write(document, request, path, out)
        content = path.read_bytes()
    out.reply(Saved(name=name, mime=mime, data=base64.b64encode(content).decode()))


def _write(document: Document, request: SaveRequest, path: Path, out: Reporter) -> None:
    design = request.design
    if document.in_space:
        _write_in_space(document, request, path, out)
        return
    if request.what == "glb":
        raise InputError("glb: models are of assemblies in space; save a picture or a film")
    if request.what == "assembly":
        write_drawing(document.flat(design).drawing, path)
        return
    if request.what.startswith("cut-"):
        _write_outlines(document, request, path)
        return
    said = command(request.of, document.file, design, pulled=request.of == "flex")
    if request.what == "stills" and request.of != "plan":
        finding = "stills: they show the steps of a plan; ask for a plan first"
        raise InputError(finding)
    if request.of == "check":
        found = document.checked(design, out)
        if request.what == "json":
            path.write_text(to_json(check_result(found, None, said)), encoding="utf-8")
        else:
            write_picture(Checked(found), path, command=said, progress=out.counted)
        return
    if request.of == "plan":
        _write_plan(document.last_plan(design, out), request.what, path, said, out)
        return
    answer = document.told(design, document.answer(design, out), out)
    if answer.search_state is SearchState.TO_COME:  # saved before the search in idle time came to an end
        said = command("flex", document.file, design, ("--search", "0"))
    answer = replace(answer, command=said)
    if request.what == "json":
        path.write_text(to_json(flex_result(answer)), encoding="utf-8")
    elif request.what == "html":
        path.write_text(page_of_answer(answer, document.kept_check(design)), encoding="utf-8")
    else:
        write_picture(answer, path, progress=out.counted)


def _write_outlines(document: Document, request: SaveRequest, path: Path) -> None:
    """Outlines to cut; in a file of the format that was opened all else in it stays as it is."""
    file, assembly = document.file, document.flat(request.design)
    made = compensated(assembly, request.kerf)
    if Path(file.name).suffix.lower() != path.suffix:
        write_drawing(made, path)
        return
    with temporary_file(file.name) as source:
        source.write_bytes(file.data)
        write_in_place(
            source, path, assembly.drawing, made.parts, unit=file.unit, flatten=file.flatten, options=file.options
        )


def _write_in_space(document: Document, request: SaveRequest, path: Path, out: Reporter) -> None:
    from wiggleroom.app.spatial_designs import designed_file

    design = request.design
    if request.what == "assembly":
        file = document.file
        path.write_text(designed_file(file.text, file.drawing, design), encoding="utf-8")
        return
    if request.what.startswith("cut-") or (request.what == "stills" and request.of != "plan"):
        message = f"{request.what}: is of drawings; {document.file.name} is an assembly in space"
        raise InputError(message)
    said = command(request.of, document.file, design, pulled=request.of == "flex")
    if request.of == "plan":
        _write_plan(document.last_plan(design, out), request.what, path, said, out)
        return
    result: Struct
    if request.of == "check":
        found = document.checked(design, out)
        result = check_result(found, command=said)
    else:
        found = replace(document.answer(design, out), command=said)
        result = flex_result(found)
    if request.what == "json":
        path.write_text(to_json(result), encoding="utf-8")
    else:
        write_picture(found, path, command=said, progress=out.counted)


def _write_plan(found: Plan, what: str, path: Path, said: str, out: Reporter) -> None:
    from wiggleroom.report.page.plan_messages import plan_options
    from wiggleroom.report.page.plan_pictures import write_stills
    from wiggleroom.report.results.plan_results import plan_result

    said = shlex.join([*shlex.split(said), *plan_options(found)])
    if what == "json":
        path.write_text(to_json(plan_result(found, said)), encoding="utf-8")
    elif what == "stills":
        with tempfile.TemporaryDirectory(prefix="wiggleroom-") as folder, zipfile.ZipFile(path, "w") as packed:
            write_stills(found, Path(folder), command=said)
            for one in sorted(Path(folder).iterdir()):
                packed.write(one, one.name)
    else:
        write_picture(found, path, command=said, progress=out.counted)
