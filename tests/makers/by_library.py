"""Files that libraries write, made anew at every test where the library is installed."""

from __future__ import annotations

import io
from collections.abc import Callable
from importlib.util import find_spec

from tests.makers.case import Case

CASES: list[Case] = []
SQUARE = [(0, 0), (30, 0), (30, 20), (0, 20)]


def moved(points, dx: float, dy: float = 0.0):
    return [(x + dx, y + dy) for x, y in points]


def written(library: str, *expected: Case) -> Callable[[Callable[[], list[bytes]]], None]:
    """Make the files of a library, in the order of what is expected of them."""

    def add(make: Callable[[], list[bytes]]) -> None:
        if find_spec(library.partition(".")[0]) is None:
            return
        for case, data in zip(expected, make(), strict=True):
            CASES.append(Case(case.name, library, data, case.parts, case.holes, case.names, case.noted, case.refused))

    return add


def expect(name: str, parts: int, holes: int = 0, names=(), noted=(), refused="") -> Case:
    return Case(name, "", b"", parts, holes, tuple(names), tuple(noted), refused)


@written(
    "svgwrite",
    expect("svgwrite_two.svg", 2, 0, ["a", "b"]),
    expect("svgwrite_page.svg", 1, 1, noted=["as large as the page"]),
    expect("svgwrite_net.svg", 4),
    expect("svgwrite_groups.svg", 2, noted=['"engraving"']),
    expect("svgwrite_polylines.svg", 2),
)
def _svgwrite():
    import svgwrite

    def page(profile="full"):
        return svgwrite.Drawing(size=("100mm", "80mm"), viewBox="0 0 100 80", profile=profile)

    line = {"fill": "none", "stroke": "black"}
    two, back, net, groups, poly = (page() for _ in range(5))
    two.add(two.rect((0, 0), (30, 20), id="a", **line))
    two.add(two.rect((30, 0), (30, 20), id="b", **line))
    back.add(back.rect((0, 0), ("100%", "100%"), fill="white"))
    back.add(back.rect((10, 10), (40, 40), **line))
    back.add(back.circle((30, 30), 5, **line))
    for start, end in (
        ((0, 0), (40, 0)),
        ((40, 0), (40, 40)),
        ((40, 40), (0, 40)),
        ((0, 40), (0, 0)),
        ((20, 0), (20, 40)),
        ((0, 20), (40, 20)),
    ):
        net.add(net.line(start, end, stroke="black"))
    cut, engraved = groups.g(id="cut"), groups.g(id="engraving")
    cut.add(groups.rect((0, 0), (30, 20), **line))
    cut.add(groups.rect((30, 0), (30, 20), **line))
    engraved.add(groups.circle((10, 10), 3, **line))
    groups.add(cut)
    groups.add(engraved)
    poly.add(poly.polyline([*SQUARE, SQUARE[0]], **line))
    poly.add(poly.polygon(moved(SQUARE, 30), **line))
    return [d.tostring().encode() for d in (two, back, net, groups, poly)]


@written(
    "drawsvg",
    expect("drawsvg_shapes.svg", 3, 1),
    expect("drawsvg_cut.svg", 2),
    expect("drawsvg_arcs.svg", 1),
    expect("drawsvg_background.svg", 2, noted=["as large as the page"]),
)
def _drawsvg():
    import drawsvg as dw

    line = {"fill": "none", "stroke": "black"}
    found = []
    for k in range(4):
        d = dw.Drawing(100, 80)
        if k == 0:
            d.append(dw.Rectangle(0, 0, 30, 20, **line))
            d.append(dw.Circle(15, 10, 4, **line))
            d.append(dw.Lines(40, 0, 60, 0, 60, 20, close=True, **line))
            d.append(dw.Ellipse(80, 30, 10, 5, **line))
        elif k == 1:
            d.append(dw.Rectangle(0, 0, 40, 20, **line))
            d.append(dw.Path(**line).M(20, 0).C(25, 5, 15, 15, 20, 20))
        elif k == 2:
            d.append(dw.Path(**line).M(0, 10).A(10, 10, 0, 0, 1, 20, 10).L(20, 30).L(0, 30).Z())
        else:
            d.append(dw.Rectangle(0, 0, 100, 80, fill="#f0f0f0"))
            d.append(dw.Rectangle(0, 0, 30, 20, **line))
            d.append(dw.Rectangle(30, 0, 30, 20, **line))
        found.append(d.as_svg().encode())
    return found


@written(
    "matplotlib",
    expect("matplotlib_patches.svg", 3),
    expect("matplotlib_compound.svg", 2, 1),
    expect("matplotlib_lines.svg", 2),
)
def _matplotlib():
    import matplotlib as mpl

    mpl.use("svg")
    from matplotlib import pyplot as plt
    from matplotlib.patches import Circle, PathPatch, Polygon, Rectangle
    from matplotlib.path import Path

    found = []
    for k in range(3):
        figure = plt.figure(figsize=(4, 3))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_xlim(0, 100)
        axes.set_ylim(0, 75)
        axes.axis("off")
        if k == 0:
            axes.add_patch(Rectangle((5, 5), 30, 20, fill=False))
            axes.add_patch(Circle((60, 30), 10, fill=False))
            axes.add_patch(Polygon([(80, 5), (95, 5), (95, 20)], fill=False))
        elif k == 1:
            rings = [SQUARE, [(5, 5), (5, 10), (10, 10), (10, 5)], moved(SQUARE, 40)]
            corners = [p for ring in rings for p in (*ring, ring[0])]
            codes = [c for ring in rings for c in (Path.MOVETO, *([Path.LINETO] * (len(ring) - 1)), Path.CLOSEPOLY)]
            axes.add_patch(PathPatch(Path(corners, codes), facecolor="orange", edgecolor="black"))
        else:
            axes.plot([5, 65, 65, 5, 5], [5, 5, 45, 45, 5], color="black")
            axes.plot([35, 35], [5, 45], color="black")
        stream = io.BytesIO()
        figure.savefig(stream, format="svg")
        plt.close(figure)
        found.append(stream.getvalue())
    return found


@written("potrace", expect("potracer_blobs.svg", 2, 1), expect("potracer_pieces.svg", 3))
def _potracer():
    import numpy as np
    import potrace

    y, x = np.mgrid[0:120, 0:200]
    ring = ((x - 50) ** 2 + (y - 60) ** 2 < 40**2) & ((x - 50) ** 2 + (y - 60) ** 2 > 15**2)
    blob = ((x - 150) ** 2 / 30**2 + (y - 60) ** 2 / 45**2) < 1
    bars = ((x // 20) % 3 == 0) & (x < 180) & (y > 10) & (y < 100) & (x % 20 > 2)
    found = []
    for bitmap in (ring | blob, bars):
        data = ""
        for curve in potrace.Bitmap(~bitmap).trace():
            data += f"M{curve.start_point.x},{curve.start_point.y}"
            for s in curve.segments:
                if s.is_corner:
                    data += f"L{s.c.x},{s.c.y}L{s.end_point.x},{s.end_point.y}"
                else:
                    data += f"C{s.c1.x},{s.c1.y} {s.c2.x},{s.c2.y} {s.end_point.x},{s.end_point.y}"
            data += "z"
        head = '<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="120mm" viewBox="0 0 200 120">'
        found.append(f'{head}<path stroke="none" fill="black" fill-rule="evenodd" d="{data}"/></svg>'.encode())
    return found


@written("svgpathtools", expect("svgpathtools_paths.svg", 2), expect("svgpathtools_net.svg", 2))
def _svgpathtools():
    import tempfile
    from pathlib import Path as File

    from svgpathtools import Arc, CubicBezier, Path, wsvg
    from svgpathtools import Line as Straight

    square = Path(*(Straight(complex(*a), complex(*b)) for a, b in zip(SQUARE, SQUARE[1:] + SQUARE[:1], strict=True)))
    disc = Path(Arc(50 + 10j, 8 + 8j, 0, False, True, 66 + 10j), Arc(66 + 10j, 8 + 8j, 0, False, True, 50 + 10j))
    wave = Path(CubicBezier(15 + 0j, 20 + 5j, 10 + 15j, 15 + 20j))
    found = []
    for paths in ([square, disc], [square, wave]):
        with tempfile.TemporaryDirectory() as folder:
            name = f"{folder}/x.svg"
            wsvg(paths, filename=name, stroke_widths=[0.1] * len(paths))
            found.append(File(name).read_bytes())
    return found


@written(
    "dxfwrite",
    expect("dxfwrite_lines.dxf", 2),
    expect("dxfwrite_polyline.dxf", 2, 1),
    expect("dxfwrite_layers.dxf", 1, noted=["ENGRAVE"]),
)
def _dxfwrite():
    import tempfile
    from pathlib import Path

    from dxfwrite import DXFEngine

    found = []
    for k in range(3):
        with tempfile.TemporaryDirectory() as folder:
            d = DXFEngine.drawing(f"{folder}/x.dxf")
            if k == 0:
                for a, b in (
                    ((0, 0), (60, 0)),
                    ((60, 0), (60, 20)),
                    ((60, 20), (0, 20)),
                    ((0, 20), (0, 0)),
                    ((30, 0), (30, 20)),
                ):
                    d.add(DXFEngine.line(a, b))
            elif k == 1:
                for points in (SQUARE, moved(SQUARE, 30)):
                    polyline = DXFEngine.polyline(points)
                    polyline.close()
                    d.add(polyline)
                d.add(DXFEngine.circle(4, (10, 10)))
            else:
                d.add_layer("ENGRAVE", color=3)
                polyline = DXFEngine.polyline(SQUARE)
                polyline.close()
                d.add(polyline)
                d.add(DXFEngine.circle(4, (10, 10), layer="ENGRAVE"))
            d.save()
            found.append(Path(f"{folder}/x.dxf").read_bytes())
    return found


@written("gdstk", expect("gdstk_polygons.svg", 2))
def _gdstk():
    import tempfile
    from pathlib import Path

    import gdstk

    cell = gdstk.Cell("TOP")
    cell.add(gdstk.rectangle((0, 0), (30, 20)), gdstk.rectangle((40, 0), (60, 20)))
    with tempfile.TemporaryDirectory() as folder:
        cell.write_svg(f"{folder}/x.svg", scaling=1)
        return [Path(f"{folder}/x.svg").read_bytes()]


@written("svg", expect("svgpy_shapes.svg", 2, 1), expect("svgpy_net.svg", 3))
def _svgpy():
    import svg

    def line(*points):
        return svg.Path(d=[svg.M(*points[0]), *(svg.L(*p) for p in points[1:])], fill="none", stroke="black")

    head = {"width": svg.mm(100), "height": svg.mm(80), "viewBox": svg.ViewBoxSpec(0, 0, 100, 80)}
    shapes = [
        svg.Rect(x=0, y=0, width=30, height=20, fill="none", stroke="black"),
        svg.Circle(cx=10, cy=10, r=4, fill="none", stroke="black"),
    ]
    shapes.append(svg.Polygon(points=[40, 0, 60, 0, 60, 20], fill="none", stroke="black"))
    net = [line((0, 0), (60, 0), (60, 20), (0, 20), (0, 0)), line((20, 0), (20, 20)), line((40, 20), (40, 0))]
    return [str(svg.SVG(elements=elements, **head)).encode() for elements in (shapes, net)]


@written("trimesh", expect("trimesh_path.dxf", 2, 1), expect("trimesh_path.svg", 2, 1))
def _trimesh():
    import shapely
    import trimesh

    shape = shapely.MultiPolygon([(SQUARE, [[(5, 5), (5, 10), (10, 10), (10, 5)]]), (moved(SQUARE, 40), [])])
    path = trimesh.path.exchange.load.load_path(shape)
    dxf, drawn = path.export(file_type="dxf"), path.export(file_type="svg")
    return [dxf.encode() if isinstance(dxf, str) else dxf, drawn.encode()]


@written("reportlab", expect("reportlab_shapes.svg", 3))
def _reportlab():
    from reportlab.graphics import renderSVG
    from reportlab.graphics.shapes import Circle, Drawing, Polygon, Rect
    from reportlab.lib import colors

    d = Drawing(200, 100)
    line = {"fillColor": None, "strokeColor": colors.black}
    for thing in (
        Rect(10, 10, 60, 40, **line),
        Circle(110, 30, 20, **line),
        Polygon([140, 10, 190, 10, 190, 60], **line),
    ):
        d.add(thing)
    return [renderSVG.drawToString(d).encode()]


@written("shapely", expect("shapely_svg.svg", 2, 1))
def _shapely():
    import shapely

    shape = shapely.MultiPolygon([(SQUARE, [[(5, 5), (5, 10), (10, 10), (10, 5)]]), (moved(SQUARE, 40), [])])
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80">'
    return [f"{head}{shape.svg(0.1)}</svg>".encode()]


@written(
    "ezdxf",
    expect("qcad_layers.dxf", 1, 1, noted=['"Beschriftung"', '"Hilfslinien"']),
    expect("fusion_sketch.dxf", 1, 2),
    expect("line_soup.dxf", 4, noted=["4 faces"]),
    expect("blocks.dxf", 3, names=["wheel", "arm"]),
    expect("texts.dxf", 2, names=["left", "right"]),
    expect("drawn_twice.dxf", 2, noted=["drawn twice"]),
    expect("splines.dxf", 1),
    expect("ends_apart.dxf", 1, noted=["joined, at most 0.01 mm"]),
    expect("hole_layer.dxf", 2, 1),
    expect("nested.dxf", 2, 1, noted=["1 outline inside another is a hole"]),
    expect("jigsaw_splines.dxf", 2, noted=["1 outline cut"]),
    expect("dimensions.dxf", 1, noted=["DIMENSION"]),
    expect("inch.dxf", 1),
    expect("crossing_lines.dxf", 1, noted=["bound nothing"]),
)
def _ezdxf():
    import ezdxf

    def closed(space, points, **attributes):
        space.add_lwpolyline(points, close=True, dxfattribs=attributes)

    made = []
    for k in range(14):
        d = ezdxf.new("R2010")
        d.units = 1 if k == 12 else 4
        space = d.modelspace()
        if k == 0:
            closed(space, moved(SQUARE, 0), layer="Kontur")
            space.add_circle((8, 8), 3, dxfattribs={"layer": "Kontur"})
            space.add_circle((20, 8), 2, dxfattribs={"layer": "Beschriftung"})
            space.add_line((-5, 10), (35, 10), dxfattribs={"layer": "Hilfslinien"})
        elif k == 1:
            for a, b in zip(SQUARE, SQUARE[1:] + SQUARE[:1], strict=True):
                space.add_line(a, b)
            space.add_circle((8, 10), 3)
            space.add_arc((20, 10), 3, 0, 180)
            space.add_arc((20, 10), 3, 180, 360)
        elif k == 2:
            for a, b in (
                ((0, 0), (40, 0)),
                ((40, 0), (40, 40)),
                ((40, 40), (0, 40)),
                ((0, 40), (0, 0)),
                ((20, 0), (20, 40)),
                ((0, 20), (40, 20)),
            ):
                space.add_line(a, b)
        elif k == 3:
            d.blocks.new("wheel").add_circle((0, 0), 5)
            closed(d.blocks.new("arm"), SQUARE)
            space.add_blockref("wheel", (60, 0))
            space.add_blockref("arm", (0, 0))
            space.add_blockref("arm", (0, 40), dxfattribs={"rotation": 90})
        elif k == 4:
            for name, x in (("left", 0), ("right", 30)):
                closed(space, moved(SQUARE, x))
                space.add_text(name, height=3).set_placement((x + 3, 5))
        elif k == 5:
            for _ in range(2):
                closed(space, SQUARE)
                space.add_circle((60, 0), 5)
        elif k == 6:
            space.add_spline(degree=3).set_closed([(0, 0, 0), (30, 0, 0), (40, 20, 0), (10, 30, 0)])
        elif k == 7:
            space.add_lwpolyline([(0, 0), (40, 0), (40, 20)])
            space.add_lwpolyline([(40, 20.01), (0, 20), (0, 0.01)])
        elif k == 8:
            closed(space, SQUARE)
            closed(space, [(5, 5), (15, 5), (15, 15), (5, 15)], layer="Holes")
            closed(space, [(6, 6), (14, 6), (14, 14), (6, 14)])
        elif k == 9:
            closed(space, [(0, 0), (60, 0), (60, 60), (0, 60)])
            closed(space, [(5, 5), (55, 5), (55, 55), (5, 55)])
            closed(space, [(6, 6), (54, 6), (54, 54), (6, 54)])
        elif k == 10:
            closed(space, [(0, 0), (60, 0), (60, 40), (0, 40)])
            space.add_spline([(30, 0), (36, 12), (24, 28), (30, 40)])
        elif k == 11:
            closed(space, SQUARE)
            space.add_linear_dim(base=(0, -10), p1=(0, 0), p2=(30, 0)).render()
        elif k == 12:
            closed(space, [(0, 0), (2, 0), (2, 1), (0, 1)])
        else:
            for a, b in (((0, -5), (0, 45)), ((40, -5), (40, 45)), ((-5, 0), (45, 0)), ((-5, 40), (45, 40))):
                space.add_line(a, b)
        stream = io.StringIO()
        d.write(stream)
        made.append(stream.getvalue().encode())
    return made
