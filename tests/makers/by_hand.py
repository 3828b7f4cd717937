"""SVG and LightBurn files written by hand in the styles of drawing programs."""

from __future__ import annotations

from tests.makers.case import Case

PAGE = 'xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 100 80"'
INKSCAPE = (
    f'<svg {PAGE} xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
    'xmlns:sodipodi="http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd">'
)
LINE = 'fill="none" stroke="#000" stroke-width="0.1"'
STYLE = 'style="fill:none;stroke:#000000;stroke-width:0.1"'


def svg(body: str, head: str = f"<svg {PAGE}>") -> bytes:
    return f"{head}{body}</svg>".encode()


def box(x: float, y: float, w: float, h: float, more: str = LINE) -> str:
    return f'<rect x="{x}" y="{y}" width="{w}" height="{h}" {more}/>'


def layer(label: str, body: str, more: str = "") -> str:
    return f'<g inkscape:groupmode="layer" inkscape:label="{label}" {more}>{body}</g>'


GRID = "".join(f'<path d="M{x} 0V60" {LINE}/>' for x in (20, 40)) + f'<path d="M0 30H60" {LINE}/>'
KNOB = "M30 0V15C30 18 36 14 36 20C36 26 30 22 30 25V40"
PAIR = box(0, 0, 30, 30) + box(30, 0, 30, 30)

FINDINGS = [
    Case("jigsaw_lines.svg", "jigsaw generator", svg(box(0, 0, 60, 60) + GRID), 6, noted=("6 faces",)),
    Case("one_cut_curve.svg", "jigsaw generator", svg(box(0, 0, 60, 40) + f'<path d="{KNOB}" {LINE}/>'), 2),
    Case(
        "t_junctions.svg",
        "hand",
        svg(box(0, 0, 60, 40) + f'<path d="M30 0V40" {LINE}/><path d="M0 20H30" {LINE}/><path d="M60 10H30" {LINE}/>'),
        4,
    ),
    Case(
        "crossing_lines.svg",
        "hand",
        svg("".join(f'<path d="M{a} -5V65M-5 {a}H65" {LINE}/>' for a in (0, 30, 60))),
        4,
        noted=("bound nothing",),
    ),
    Case(
        "ends_apart.svg",
        "CAD export",
        svg(f'<path d="M0 0H40V20.01" {LINE}/><path d="M40 20.02H0V0.01" {LINE}/>'),
        1,
        noted=("joined, at most 0.01 mm",),
    ),
    Case(
        "ends_too_far.svg",
        "CAD export",
        svg(box(50, 0, 10, 10) + f'<path d="M0 0H40V20H0V3.9" {LINE}/>'),
        1,
        noted=("its ends 3.9 mm apart",),
    ),
    Case(
        "loops_with_gaps.svg",
        "CAD export",
        svg(
            f'<path d="M0 0H40V20H0V3" {LINE}/>'
            + "".join(
                f'<path d="M{x} 0.3V20M{x + 20.3} 0V20.3M{x + 20} 20.3H{x}M{x + 20} 0H{x}" {LINE}/>' for x in (50, 80)
            )
        ),
        3,
        noted=("joined, at most 3 mm apart, at (0, ",),
    ),
    Case(
        "lines_side_by_side.svg",
        "CAD export",
        svg(box(50, 0, 10, 10) + "".join(f'<path d="M{x} 0V60" {LINE}/>' for x in (0, 0.3, 10, 10.3, 10.6, 20, 21))),
        1,
        noted=("open paths are left out",),
    ),
    Case(
        "ends_joined.svg",
        "CAD export",
        svg(f'<path d="M0 0H40V20H0V0.6" {LINE}/>'),
        1,
        options=(("join", 0.7),),
    ),
    Case(
        "corner_loops.svg",
        "boxes.py style",
        svg(f'<path d="M0 0H40V20H20C20.1 20 20 20.1 20 20V10H0z" {LINE}/>'),
        1,
        noted=("1 loop",),
    ),
    Case("spike.svg", "hand", svg(f'<path d="M0 0H40V10L40.010 10L40 10V20H0z" {LINE}/>'), 1, noted=("1 spike",)),
    Case(
        "rounding_overlap.svg",
        "hand",
        svg(box(0, 0, 30.00001, 30) + box(30, 0, 30, 30)),
        2,
        options=(("gap", 0.1),),
    ),
    Case("drawn_twice.svg", "LightBurn", svg(box(0, 0, 30, 30) * 2 + box(40, 0, 20, 20)), 2, noted=("drawn twice",)),
    Case(
        "labels.svg",
        "Inkscape",
        svg(
            f'<rect id="rect12" inkscape:label="lid" width="30" height="30" {STYLE}/>'
            f'<rect id="rect14" inkscape:label="base" x="40" width="30" height="30" {STYLE}/>',
            INKSCAPE,
        ),
        2,
        names=("lid", "base"),
    ),
    Case(
        "engraving_layer.svg",
        "Inkscape",
        svg(layer("Cut", box(0, 0, 60, 40)) + layer("Engrave", box(10, 10, 20, 10) + box(40, 10, 5, 5)), INKSCAPE),
        1,
        noted=('2 elements in "Engrave"',),
    ),
    Case(
        "engraving_colour.svg",
        "laser house",
        svg(box(0, 0, 60, 40) + box(10, 10, 5, 5, 'fill="none" stroke="blue"')),
        1,
        noted=("(--skip)",),
        options=(("skip", ("blue",)),),
    ),
    Case(
        "text_outlines.svg",
        "Inkscape",
        svg(
            box(0, 0, 60, 40)
            + '<g id="text837" aria-label="Hi"><path d="M10 10h2v8h-2z"/><path d="M14 10h2v8h-2z"/></g>',
            INKSCAPE,
        ),
        1,
        noted=('in "text837"',),
    ),
    Case(
        "circle_inside.svg",
        "hand",
        svg(box(0, 0, 60, 40) + f'<circle cx="20" cy="20" r="5" {LINE}/>' + box(35, 15, 15, 3)),
        1,
        2,
        noted=("2 outlines inside others are holes",),
    ),
    Case(
        "openscad.svg",
        "OpenSCAD",
        b'<?xml version="1.0" standalone="no"?><!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" '
        b'"http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">'
        b'<svg width="70mm" height="30mm" viewBox="0 -30 70 30" xmlns="http://www.w3.org/2000/svg" version="1.1">'
        b'<title>OpenSCAD Model</title><path d="M 30,-0 L 0,-0 L 0,-30 L 30,-30 z M 10,-10 L 20,-10 L 20,-20 L 10,-20 z '
        b'M 70,-0 L 40,-0 L 40,-30 L 70,-30 z" stroke="black" fill="lightgray" stroke-width="0.5"/></svg>',
        2,
        1,
        noted=("each piece is a part",),
    ),
    Case(
        "page_rectangle.svg",
        "matplotlib style",
        svg('<rect width="100%" height="100%" style="fill:#ffffff"/>' + PAIR),
        2,
        noted=("as large as the page",),
    ),
    Case("sheet.svg", "hand", svg("".join(box(20 * i, 30 * j, 15, 20) for i in range(3) for j in range(2))), 6),
    Case(
        "pin_by_design.svg",
        "hand",
        svg(box(0, 0, 40, 10, f'id="bar" {LINE}') + box(30, 5, 20, 10, f'id="other" {LINE}')),
        2,
        refused="--ignore bar,other",
    ),
]
"""Kinds of drawings that were once read wrong."""

STYLES = [
    # Inkscape
    Case(
        "fixed_layer.svg",
        "Inkscape",
        svg(layer("fixed", box(0, 0, 40, 40)) + layer("moving", box(40, 0, 20, 20)), INKSCAPE),
        2,
        names=("fixed", "moving"),
    ),
    Case(
        "titles.svg",
        "Inkscape",
        svg(
            f'<rect id="rect1" width="20" height="20" {STYLE}><title>left</title></rect>' + box(20, 0, 20, 20), INKSCAPE
        ),
        2,
        names=("left", "p2"),
    ),
    Case(
        "hidden_layer.svg",
        "Inkscape",
        svg(layer("Cut", box(0, 0, 40, 40)) + layer("draft", box(0, 0, 9, 9), 'style="display:none"'), INKSCAPE),
        1,
        noted=("hidden layer",),
    ),
    Case(
        "german_layers.svg",
        "Inkscape",
        svg(
            layer("Schneiden", box(0, 0, 60, 40))
            + layer("Gravur", box(5, 5, 9, 9))
            + layer("Hilfslinien", f'<path d="M0 20H60" {LINE}/>')
            + layer("Beschriftung", box(20, 20, 3, 3)),
            INKSCAPE,
        ),
        1,
        noted=("Gravur", "Hilfslinien", "Beschriftung"),
    ),
    Case(
        "french_layers.svg",
        "Inkscape",
        svg(layer("Découpe", PAIR) + layer("Gravure", box(5, 5, 9, 9)) + layer("Cotes", box(5, 25, 9, 1)), INKSCAPE),
        2,
        noted=("Gravure", "Cotes"),
    ),
    Case(
        "spanish_layers.svg",
        "Inkscape",
        svg(layer("Corte", PAIR) + layer("Grabado", box(5, 5, 9, 9)) + layer("Guías", box(5, 25, 9, 1)), INKSCAPE),
        2,
        noted=("Grabado", "Guías"),
    ),
    Case(
        "chinese_layers.svg",
        "Inkscape",
        svg(layer("切割", PAIR) + layer("雕刻", box(5, 5, 9, 9)) + layer("文字", box(5, 25, 9, 1)), INKSCAPE),
        2,
        noted=("雕刻", "文字"),
    ),
    Case(
        "russian_layers.svg",
        "Inkscape",
        svg(layer("Рез", PAIR) + layer("Гравировка", box(5, 5, 9, 9)), INKSCAPE),
        2,
        noted=("Гравировка",),
    ),
    Case(
        "chinese_names.svg",
        "Inkscape",
        svg(f'<rect id="rect1" inkscape:label="盖子" width="20" height="20" {STYLE}/>', INKSCAPE),
        1,
        names=("盖子",),
    ),
    Case(
        "clones.svg",
        "Inkscape",
        svg(
            f'<rect id="rect1" width="20" height="20" {STYLE}/><use href="#rect1" x="20"/><use href="#rect1" x="40"/>',
            INKSCAPE,
        ),
        3,
    ),
    Case(
        "copied_ids.svg",
        "hand",
        svg(box(0, 0, 20, 20, f'id="a" {LINE}') + box(20, 0, 20, 20, f'id="a" {LINE}')),
        2,
        names=("a", "a-2"),
        noted=("used more than once",),
    ),
    # Illustrator
    Case(
        "illustrator_classes.svg",
        "Illustrator",
        svg(
            "<style>.st0{fill:none;stroke:#000000;stroke-width:0.25;}.st1{fill:#231F20;}</style>"
            '<g id="Layer_1"><rect class="st0" width="60" height="40"/><circle class="st0" cx="20" cy="20" r="4"/>'
            '<path class="st1" d="M30 10h6v6h-6z"/></g>'
        ),
        1,
        1,
        noted=("filled without a line",),
    ),
    Case(
        "illustrator_artboard.svg",
        "Illustrator",
        svg('<rect width="100" height="80" fill="none"/>' + PAIR),
        2,
        noted=("without line or fill",),
    ),
    Case(
        "illustrator_x_names.svg",
        "Illustrator",
        svg(
            f'<g id="side_x5F_left"><rect width="30" height="30" {LINE}/></g><g id="XMLID_2_"><path d="M30 0h9v9h-9z" {LINE}/></g>'
        ),
        2,
        names=("side_x5F_left",),
    ),
    Case(
        "illustrator_compound.svg",
        "Illustrator",
        svg('<path fill="#fff" stroke="#000" d="M0 0h60v40H0V0zM10 10v5h5v-5H10zM30 10v20h10V10H30z"/>'),
        1,
        2,
    ),
    # Affinity, Corel, Fusion, Onshape, browsers
    Case(
        "affinity_matrix.svg",
        "Affinity",
        svg(
            '<g transform="matrix(1,0,0,1,10,10)"><g id="Artboard1" transform="matrix(0.5,0,0,0.5,0,0)">'
            '<path d="M0,0L60,0L60,60L0,60L0,0Z" style="fill:none;stroke:black;stroke-width:1px;"/>'
            '<g transform="matrix(1,0,0,1,60,0)"><path d="M0,0L60,0L60,60L0,60L0,0Z" style="fill:none;stroke:black;"/></g></g></g>',
            '<svg width="100%" height="100%" viewBox="0 0 100 80" xmlns="http://www.w3.org/2000/svg">',
        ),
        2,
    ),
    Case(
        "corel_classes.svg",
        "CorelDRAW",
        svg(
            '<defs><style type="text/css"><![CDATA[.str0 {stroke:#373435;stroke-width:0.2} .fil0 {fill:none}]]></style></defs>'
            '<g id="Layer_x0020_1"><metadata id="CorelCorpID_0Corel-Layer"/><polygon class="fil0 str0" points="0,0 30,0 30,30 0,30"/>'
            '<polygon class="fil0 str0" points="30,0 60,0 60,30 30,30"/></g>'
        ),
        2,
    ),
    Case(
        "fusion_segments.svg",
        "Fusion 360",
        svg(
            "".join(
                f'<path d="{d}" fill="none" stroke="rgb(0,0,0)" stroke-width="0.02"/>'
                for d in (
                    "M0 0 L40 0",
                    "M40 0 L40 30",
                    "M40 30 L0 30",
                    "M0 30 L0 0",
                    "M25 15 A5 5 0 1 0 15 15",
                    "M15 15 A5 5 0 1 0 25 15",
                )
            )
        ),
        1,
        1,
    ),
    Case(
        "onshape_lines.svg",
        "Onshape",
        svg(
            "".join(
                f'<line x1="{a}" y1="{b}" x2="{c}" y2="{d}" stroke="black" stroke-width="0.1"/>'
                for a, b, c, d in ((0, 0, 40, 0), (40, 0, 40, 30), (0, 30, 40, 30), (0, 0, 0, 30), (20, 0, 20, 30))
            )
        ),
        2,
    ),
    Case(
        "figma_groups.svg",
        "Figma",
        svg(
            '<g id="Frame 1"><rect id="lid" x="0.5" y="0.5" width="29" height="29" stroke="black" '
            'fill="none"/><g id="pin"><circle cx="50" cy="15" r="8" stroke="black" fill="none"/></g></g>'
        ),
        2,
        names=("lid", "pin"),
    ),
    Case(
        "kerf_in_one.svg",
        "tray maker",
        svg(box(0, 0, 60, 60) + box(5, 5, 50, 50) + box(6, 6, 48, 48)),
        2,
        1,
        noted=("1 outline inside another is a hole",),
    ),
    Case(
        "tray_of_touching_pieces.svg",
        "tray maker",
        svg(box(0, 0, 60, 60) + "".join(box(10 + 20 * i, 10 + 20 * j, 20, 20) for i in (0, 1) for j in (0, 1))),
        5,
        1,
        noted=("4 outlines inside others are parts",),
    ),
    Case(
        "all_in_one_path.svg",
        "combined path",
        svg(f'<path d="M0 0H60V60H0zM10 10H50V50H10zM15 15H45V45H15z" {LINE}/>'),
        2,
        1,
    ),
    Case(
        "holes_in_pieces.svg",
        "hand",
        svg(PAIR + "".join(f'<circle cx="{x}" cy="15" r="3" {LINE}/>' for x in (10, 20, 40, 50))),
        2,
        4,
    ),
    Case(
        "solid_by_name.svg",
        "hand",
        svg(box(0, 0, 60, 60) + f'<circle id="disc" cx="30" cy="30" r="10" {LINE}/>'),
        2,
        1,
        names=("disc",),
        options=(("solid", ("disc",)),),
    ),
    Case(
        "solid_by_point.svg",
        "hand",
        svg(box(0, 0, 60, 60) + f'<circle cx="30" cy="30" r="10" {LINE}/>'),
        2,
        1,
        options=(("solid", ("@30,50",)),),
    ),
    Case(
        "filled_inlay.svg",
        "hand",
        svg(
            box(0, 0, 60, 60, 'fill="#ddd" stroke="black"')
            + '<circle id="inlay" cx="30" cy="30" r="10" fill="#fa0" stroke="black"/>'
        ),
        2,
        1,
        names=("inlay",),
    ),
    Case(
        "text_names.svg",
        "hand",
        svg(
            PAIR
            + '<text x="5" y="15" font-size="4">left</text><text x="40" y="15" font-size="4"><tspan>right</tspan></text>'
        ),
        2,
        names=("left", "right"),
    ),
    Case(
        "text_beats_automatic_id.svg",
        "hand",
        svg(box(0, 0, 30, 30, f'id="rect99" {LINE}') + '<text x="5" y="15" font-size="4">lid</text>'),
        1,
        names=("lid",),
    ),
    Case("reversed_points.svg", "hand", svg(f'<path d="M0 0H40H20H40V20H0z" {LINE}/>'), 1, noted=("spike",)),
    Case("repeated_points.svg", "hand", svg(f'<path d="M0 0H40L40 0L40 0V20V20H0L0 0z" {LINE}/>'), 1),
    Case(
        "touches_itself.svg",
        "hand",
        svg(f'<path d="M0 0H20V10H40V20H20V10H0z" {LINE}/>'),
        2,
        noted=("touches itself",),
    ),
    Case(
        "hole_by_slit.svg",
        "hand",
        svg(f'<path d="M0 0H60V40H0V20H20V30H40V10H20V20H0z" {LINE}/>'),
        1,
        1,
        noted=("touches itself",),
    ),
    Case("bow_tie.svg", "hand", svg(f'<path d="M0 0L40 40L40 0L0 40z" {LINE}/>'), 1, refused="crosses itself"),
    Case(
        "overlapping_outlines.svg",
        "hand",
        svg(box(0, 0, 30, 30, f'id="a" {LINE}') + box(20, 20, 30, 30, f'id="b" {LINE}')),
        2,
        refused="--glue a,b",
    ),
    Case(
        "overlapping_with_line.svg",
        "hand",
        svg(
            box(0, 0, 30, 30, f'id="a" {LINE}') + box(20, 20, 30, 30, f'id="b" {LINE}') + f'<path d="M5 0V30" {LINE}/>'
        ),
        2,
        refused="--ignore p2,b",
    ),
    Case("sharing_an_edge.svg", "hand", svg(PAIR + box(0, 30, 60, 10)), 3),
    Case(
        "dashed_guides.svg",
        "hand",
        svg(PAIR + f'<g class="guides"><path d="M0 15H60" {LINE}/></g>'),
        2,
        noted=('in "guides"',),
    ),
    Case(
        "only_layer.svg",
        "Inkscape",
        svg(layer("A", PAIR) + layer("B", box(70, 0, 9, 9)), INKSCAPE),
        1,
        options=(("only", ("B",)),),
        noted=("(--only)",),
    ),
    Case(
        "arcs_twice_with_two_commands.svg",
        "jigsaw generator",
        svg(
            box(0, 0, 60, 40)
            + f'<path d="M30 0V15A5 5 0 0 1 30 25V40" {LINE}/><path d="M30 40V25A5 5 0 0 0 30 15V0" {LINE}/>'
        ),
        2,
        noted=("drawn twice",),
    ),
    Case("only_open.svg", "hand", svg(f'<path d="M0 0H40V20" {LINE}/>'), 0, refused="but 1 open"),
    Case(
        "inch_page.svg",
        "Rhino",
        svg(box(0, 0, 2, 1), '<svg xmlns="http://www.w3.org/2000/svg" width="4in" height="3in" viewBox="0 0 4 3">'),
        1,
    ),
    Case(
        "potrace.svg",
        "potrace",
        b'<svg version="1.0" xmlns="http://www.w3.org/2000/svg" width="100pt" height="80pt" viewBox="0 0 100 80">'
        b'<metadata>Created by potrace 1.16</metadata><g transform="translate(0,80) scale(0.1,-0.1)" fill="#000000" stroke="none">'
        b'<path d="M100 400 c0 -200 20 -220 200 -220 180 0 200 20 200 220 0 180 -20 200 -200 200 -180 0 -200 -20 -200 -200z '
        b'm250 0 c0 -50 -20 -50 -50 -50 -30 0 -50 0 -50 50 0 50 20 50 50 50 30 0 50 0 50 -50z"/>'
        b'<path d="M600 400 l200 0 0 200 -200 0 0 -200z"/></g></svg>',
        2,
        1,
    ),
]


def lightburn(body: str, settings: str = "") -> bytes:
    head = '<?xml version="1.0" encoding="UTF-8"?><LightBurnProject AppVersion="1.4.03" FormatVersion="1">'
    return f"{head}{settings}{body}</LightBurnProject>".encode()


def setting(index: int, name: str, kind: str = "Cut") -> str:
    return f'<CutSetting type="{kind}"><index Value="{index}"/><name Value="{name}"/></CutSetting>'


def shape(kind: str, more: str, x: float = 0, y: float = 0, cut: int = 0, inside: str = "") -> str:
    return f'<Shape Type="{kind}" CutIndex="{cut}" {more}><XForm>1 0 0 1 {x} {y}</XForm>{inside}</Shape>'


RECT = 'W="30" H="20" Cr="0"'
PATH = (
    "<VertList>V0 0c0x1c1x1V40 0c0x45c0y5c1x1V40 20c0x1c1x45c1y15V0 20c0x1c1x1</VertList>"
    "<PrimList>L0 1B1 2L2 3L3 0</PrimList>"
)
LIGHTBURN = [
    Case("rects.lbrn2", "LightBurn", lightburn(shape("Rect", RECT) + shape("Rect", RECT, 30)), 2),
    Case(
        "ellipse_in_rect.lbrn2", "LightBurn", lightburn(shape("Rect", RECT) + shape("Ellipse", 'Rx="4" Ry="4"')), 1, 1
    ),
    Case("path.lbrn2", "LightBurn", lightburn(shape("Path", "", inside=PATH)), 1),
    Case(
        "closed_polyline.lbrn2",
        "LightBurn",
        lightburn(
            shape(
                "Path",
                "",
                inside="<VertList>V0 0c0x1c1x1V9 0c0x1c1x1V9 9c0x1c1x1</VertList><PrimList>LineClosed</PrimList>",
            )
        ),
        1,
    ),
    Case(
        "fill_layer.lbrn2",
        "LightBurn",
        lightburn(
            shape("Rect", RECT) + shape("Ellipse", 'Rx="4" Ry="4"', cut=2),
            setting(0, "Cut") + setting(2, "Logo", "Scan"),
        ),
        1,
        noted=("filled layer",),
    ),
    Case(
        "tool_layer.lbrn2",
        "LightBurn",
        lightburn(shape("Rect", RECT) + shape("Rect", RECT, 3, 3, cut=30)),
        1,
        noted=("tool layer",),
    ),
    Case(
        "engrave_layer.lbrn2",
        "LightBurn",
        lightburn(
            shape("Rect", RECT) + shape("Ellipse", 'Rx="4" Ry="4"', cut=1), setting(0, "C00") + setting(1, "Engrave")
        ),
        1,
        noted=('in "Engrave"',),
    ),
    Case(
        "shared_vertices.lbrn2",
        "LightBurn",
        lightburn(
            f'<Shape Type="Path" CutIndex="0" VertID="0" PrimID="0"><XForm>1 0 0 1 0 0</XForm>{PATH}</Shape>'
            '<Shape Type="Path" CutIndex="0" VertID="0" PrimID="0"><XForm>1 0 0 1 60 0</XForm></Shape>'
        ),
        2,
    ),
    Case(
        "drawn_twice.lbrn2",
        "LightBurn",
        lightburn(shape("Rect", RECT) * 2),
        1,
        noted=("drawn twice",),
    ),
    Case(
        "group_and_text.lbrn2",
        "LightBurn",
        lightburn(
            '<Shape Type="Group"><XForm>2 0 0 2 10 10</XForm><Children>'
            + shape("Rect", RECT)
            + '<Shape Type="Text" CutIndex="0" Str="lid"><XForm>1 0 0 1 0 0</XForm></Shape></Children></Shape>'
        ),
        1,
        names=("lid",),
    ),
    Case(
        "old.lbrn",
        "LightBurn",
        lightburn(
            '<Shape Type="Path" CutIndex="0"><XForm>1 0 0 1 0 0</XForm><V vx="0" vy="0"/><V vx="9" vy="0"/><V vx="9" vy="9"/>'
            '<P T="L" p0="0" p1="1"/><P T="L" p0="1" p1="2"/><P T="L" p0="2" p1="0"/></Shape>'
        ),
        1,
    ),
]
