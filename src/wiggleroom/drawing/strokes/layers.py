"""Which strokes are cut: engraving, guides, texts and backgrounds are left out, and said."""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from difflib import get_close_matches
from functools import lru_cache

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.strokes.colours import colour_of, is_light, name_of
from wiggleroom.drawing.strokes.elements import Artwork, Stroke
from wiggleroom.drawing.strokes.read_options import ReadOptions
from wiggleroom.drawing.strokes.strokes import trace
from wiggleroom.errors import InputError

ENGRAVING_WORDS = (
    "engrav", "etch", "raster", "scor", "gravur", "gravier", "gravure", "graver", "gravyr", "grabad", "grabar",
    "gravac", "gravar", "incision", "incid", "ritz", "marquage", "marcad", "marcatur", "grawer", "gravirov",
    "гравир", "雕刻", "刻字", "彫刻", "刻印", "각인", "kazima",
)  # fmt: skip
"""How words for what is engraved or scored begin; enough to leave out a single element that is called so."""
AUXILIARY_WORDS = (
    "mark", "fold", "crease", "bend", "falz", "falt", "rill", "pli", "plieg", "piega", "dobra", "gesto", "折",
    "guide", "guia", "guida", "helper", "construct", "konstruktion", "hilfs", "hulp", "centerline", "centreline",
    "mittellinie", "ガイド", "辅助", "參考", "参考",
    "text", "texte", "texto", "testo", "tekst", "текст", "letter", "font", "schrift", "文字", "文本", "텍스트",
    "label", "beschriftung", "annot", "note", "notiz", "comment", "kommentar", "info", "etiquet", "etichett",
    "dimension", "dim", "dims", "bemas", "bemass", "masse", "cote", "cotes", "cota", "cotas", "acotad", "quote",
    "maat", "kota", "寸法", "标注", "치수",
    "hidden", "verdeckt", "cache", "oculto", "nascost", "invisible", "background", "hintergrund", "fond", "fondo",
    "sfondo", "reference", "referenz", "watermark", "title block", "titleblock", "schriftfeld", "nocut", "ignore",
    "defpoints", "origin", "nullpunkt",
)  # fmt: skip
"""How words for layers of guides, folds, texts, dimensions and the like begin."""
_WHOLE = {"mark", "fold", "bend", "pli", "note", "dim", "dims", "cote", "cotes", "cota", "cotas", "quote", "masse",
          "info", "font", "cache", "origin", "fond", "guide", "text", "texte", "texto", "letter", "label"}  # fmt: skip
"""Those that must be the whole word, or its plural or its number: "marks", "text12"."""
_BEGINNINGS = tuple(word for word in AUXILIARY_WORDS if word not in _WHOLE)
_WORDS = {f"{word}{ending}" for word in AUXILIARY_WORDS if word in _WHOLE for ending in ("", "s", "n")}
HOLE_WORDS = (
    "hole",
    "loch",
    "locher",
    "bohrung",
    "trou",
    "agujero",
    "foro",
    "fori",
    "furo",
    "gat",
    "gaten",
    "otwor",
    "отверст",
    "孔",
    "穴",
)
CUT_NAMES = {
    "hole", "slot", "notch", "cutout", "cutaway", "relief", "dogbone", "opening", "mortise", "mortice", "inside", "inner",
    "interior", "schlitz", "ausschnitt", "aussparung", "kerbe", "langloch", "durchbruch", "innen", "innenkontur", "fente",
    "encoche", "mortaise", "rainure", "interieur", "ranura", "muesca", "interno", "asola", "fessura", "fenda", "ranhura",
    "entalhe", "sleuf", "gleuf", "inkeping", "uitsparing", "wyciecie", "szczelina", "паз", "вырез", "槽", "スリット",
}  # fmt: skip
"""Words, and their plurals, for what is cut out of a part; HOLE_WORDS besides."""
PART_NAMES = {
    "cover", "plug", "cap", "plate", "panel", "lid", "part", "piece", "board", "insert", "key", "pin", "peg", "filler", "ring",
    "frame", "box", "wall", "side", "tray", "deckel", "platte", "teil", "stopfen", "couvercle", "tapa", "pieza",
}  # fmt: skip
"""Words that say that a name such as "slot cover" is that of a part all the same."""
REFERENCE_LINE_TYPES = (
    "center", "centre", "hidden", "phantom", "dashdot", "divide", "border", "axis", "axes", "mitte", "achse", "verdeckt", "strichpunkt",
)  # fmt: skip
"""How names of line types for centre lines and hidden edges begin in CAD programs."""
LABELS = "labels"
"""Names for people to read stand in a layer of this name; nothing is said about it."""
CUT_WORDS = ("inner", "outer", "cut", "through")
"""Words that say that a line is cut whatever stands beside them, as in "text cut"."""
NOT_CUT = re.compile(
    r"\b(?:do ?(?:not|nt)|don t|dont|no|not|never|non|nie|nicht|kein\w*|ne pas|nao|niet|не) ?(?:laser ?)?"
    r"(?:cut|schneid\w*|schnitt|decoup\w*|coup\w*|cort\w*|taglia\w*|snij\w*|tnij|ciac|ciecia|резать)\b"
    r"|\bdonotcut\b|\bnocut\b|\bdesign template\b|不切|不要切|切らない|カットしない|자르지"
)
"""What says that something is not cut, in words in small letters without accents."""
SHEET_WORDS = {
    "sheet", "sheets", "stock", "workpiece", "material", "workarea", "worksheet", "artboard", "canvas", "billet",
    "bogen", "werkstuck", "rohmaterial", "rohteil", "rohling", "arbeitsbereich", "arbeitsflache", "zeichenflache", "plattenrand",
    "blattrand", "blatt", "feuille", "matiere", "materiau", "brut", "hoja", "plancha", "lienzo", "foglio", "materiale", "grezzo",
    "folha", "chapa", "vel", "materiaal", "werkstuk", "werkgebied", "arkusz", "obrabiany", "лист", "материал", "заготовка",
    "板材", "材料", "纸张", "紙張", "工作区", "工件", "幅面", "素材", "用紙", "シート", "ワーク", "作業領域", "재료", "시트",
    "ark", "materjal",
}  # fmt: skip
"""Words for the sheet that parts are cut from, and for the place where it lies."""
FRAME_WORDS = {
    "frame", "border", "borders", "boundary", "bounds", "bed", "page", "table", "paper", "machine", "laserbed", "rahmen", "rand",
    "seite", "papier", "tisch", "begrenzung", "cadre", "bordure", "bord", "plateau", "marco", "borde", "pagina", "mesa",
    "cornice", "bordo", "piano", "moldura", "borda", "quadro", "margem", "kader", "bladzijde", "ramka", "obramowanie",
    "рамка", "граница", "стол", "страница", "边框", "邊框", "边界", "邊界", "页面", "頁面", "外框", "枠", "外枠", "台紙", "ページ",
    "테두리",
}  # fmt: skip
"""Words for what may be the sheet's edge, or a frame that is a part."""
SHEET_BESIDE = {
    "size", "outline", "edge", "area", "work", "working", "cutting", "cut", "laser", "limit", "limits", "rect", "mm",
    "layer", "the", "of", "guide", "iso", "din", "ansi", "jis", "ebene", "calque", "capa", "livello", "laag", "zone",
    "travail", "trabajo", "di", "de", "lavoro", "trabalho", "x", "a",
} | FRAME_WORDS  # fmt: skip
"""Words that stand beside those and change nothing."""
SHEET_PHRASES = re.compile(
    r"\b(?:work(?:ing)? area|cutting area|area de trabajo|area de trabalho|area di lavoro|zone de travail)\b"
)
OUTSIDE_WORDS = (
    "outside",
    "outer",
    "exterior",
    "external",
    "aussen",
    "exterieur",
    "esterno",
    "buiten",
    "外",
    "outline",
)
"""How words for lines begin that are cut on their outside."""
OUTLINE_NAMES = {
    "outline",
    "outlines",
    "contour",
    "umriss",
    "aussenkontur",
    "contorno",
    "omtrek",
    "obrys",
    "контур",
    "外形",
}
"""Names of the one outline of a part, by which what lies in it is cut out."""
POCKET_WORDS = {"pocket", "pockets", "pocketing", "tasche", "taschen", "poche", "poches", "vcarve", "halftone"}
"""Words for what is milled, but not through, ..."""
COUNTERSINK = re.compile(
    r"\bcounter ?(?:sink|sunk|bore)|\bc ?(?:sink|bore)|\bcsk\b|\bsenk(?:ung|er)|\bansenk|\bfraisur|\bavellan|\bsvasat"
)
"""... and for the wider part of holes for screws."""
PAGE = "page"
"""What `--skip` calls the edge of the page."""
_REFERENCE = re.compile(r"burn:\s*[\d.]+\s*mm")
"""What stands in the bar by which the scale of a boxes.py sheet is checked."""


def cut_strokes(artwork: Artwork, options: ReadOptions) -> tuple[Artwork, tuple[tuple[str, Stroke], ...]]:
    """Artwork with the strokes that are cut, and those left out, each with the reason.

    Raises
    ------
    InputError
        Where an option names nothing that is in the file.
    """
    wanted = _chosen(artwork, options)
    reasons: list[str] = []
    notes: list[str] = []
    drawn = [bool(s.colour or s.fill) for s in artwork.strokes]
    template = any(_PONOKO in (s.colour, s.fill) for s in artwork.strokes) and any(
        s.colour == _PONOKO_CUT for s in artwork.strokes
    )
    for stroke, visible in zip(artwork.strokes, drawn, strict=True):
        reason = wanted(stroke) or _usual(artwork, stroke, visible or not any(drawn))
        if template and not reason and not options.only and stroke.colour != _PONOKO_CUT:
            reason = f"not {name_of(_PONOKO_CUT)}, the colour of cuts on a template of Ponoko; --only COLOUR reads it"
        reasons.append(reason)
    if all(reasons) and not options.only and not options.skip:
        reasons = [reason if reason == _SILENT else "" for reason in reasons]
        notes.append(f"{artwork.file}: everything stands in layers that are usually not cut; all of it is read")
    if not options.only:
        _reference_lines(artwork, reasons)
        if "all" not in options.solid:
            _drawing_border(artwork, reasons)
        _reference_bar(artwork, reasons)
        _filled(artwork, reasons, options)
    kept = tuple(s for s, reason in zip(artwork.strokes, reasons, strict=True) if not reason)
    out = tuple((reason, s) for s, reason in zip(artwork.strokes, reasons, strict=True) if reason and reason != _SILENT)
    counts = Counter(reason for reason, _ in out)
    notes += [f"{artwork.file}: left out: {_count(n)} {reason}" for reason, n in counts.items()]
    colours = Counter(name_of(s.colour) for s in kept if s.colour and not s.hole and not s.fixed)
    if len(colours) > 1 and not options.only and not options.skip:
        listed = ", ".join(f"{colour} {n}" for colour, n in colours.most_common(6))
        notes.append(f"{artwork.file}: lines of all colours are cut ({listed}); --skip COLOUR leaves one out")
    return replace(artwork, strokes=kept, notes=(*artwork.notes, *notes)), out


_SILENT = "labels"


def is_engraved(word: str) -> bool:
    """Whether a word says that something is engraved or scored.

    Examples
    --------
    >>> is_engraved("Gravur 2"), is_engraved("lid")
    (True, False)
    """
    return any(token.startswith(ENGRAVING_WORDS) for token in _tokens(word))


@lru_cache(4096)
def is_auxiliary_layer(word: str) -> bool:
    """Whether a layer of this name holds what is not cut.

    Examples
    --------
    >>> [is_auxiliary_layer(word) for word in ("Engraving", "DO-NOT-CUT", "text-12", "文字", "textile", "cut", "Text cut")]
    [True, True, True, True, False, False, False]
    """
    tokens = _tokens(word)
    phrase = " ".join(tokens)
    if NOT_CUT.search(phrase):
        return True
    if set(tokens) & set(CUT_WORDS):
        return False
    return (
        bool(set(tokens) & POCKET_WORDS)
        or bool(COUNTERSINK.search(phrase))
        or is_engraved(word)
        or any(token.startswith(_BEGINNINGS) or token in _WORDS for token in (*tokens, phrase))
    )


def says_cut(word: str) -> bool:
    """Whether the name of a layer says that it is cut.

    Examples
    --------
    >>> says_cut("Cut 2"), says_cut("Layer 2")
    (True, False)
    """
    return bool(set(_tokens(word)) & set(CUT_WORDS)) or is_cut_name(word)


def is_hole_layer(word: str) -> bool:
    """Whether outlines on a layer of this name are holes.

    Examples
    --------
    >>> [is_hole_layer(word) for word in ("Hole_3mm", "Löcher", "whole")]
    [True, True, False]
    """
    return any(token.startswith(HOLE_WORDS) for token in _tokens(word)[:1])


def names_sheet(word: str) -> bool:
    """Whether a word says that something is the sheet, and nothing else.

    Examples
    --------
    >>> [names_sheet(word) for word in ("Sheet 600x400", "Stock", "Werkstück", "cover sheet", "frame")]
    [True, True, True, False, False]
    """
    tokens = set(_tokens(word))
    return bool(SHEET_PHRASES.search(" ".join(_tokens(word)))) or bool(
        tokens & SHEET_WORDS and tokens <= SHEET_WORDS | SHEET_BESIDE
    )


def may_be_sheet(word: str) -> bool:
    """Whether a word may mean the sheet's edge, or a frame that is a part.

    Examples
    --------
    >>> [may_be_sheet(word) for word in ("Frame", "laser bed", "bedroom")]
    [True, True, False]
    """
    tokens = set(_tokens(word))
    return bool(tokens & FRAME_WORDS and tokens <= SHEET_WORDS | SHEET_BESIDE)


def is_outside_layer(word: str) -> bool:
    """Whether lines on a layer of this name are cut on their outside.

    Examples
    --------
    >>> is_outside_layer("Outside"), is_outside_layer("Layer 1")
    (True, False)
    """
    return any(token.startswith(OUTSIDE_WORDS) for token in _tokens(word))


def is_outline_name(word: str) -> bool:
    """Whether a name is that of the outline of a part, and not of the part.

    Examples
    --------
    >>> is_outline_name("Outline 2"), is_outline_name("Outer frame")
    (True, False)
    """
    return len(_tokens(word)) == 1 and _tokens(word)[0] in OUTLINE_NAMES


@lru_cache(4096)
def is_cut_name(word: str) -> bool:
    """Whether a name is one of a hole, slot or notch.

    Examples
    --------
    >>> [is_cut_name(word) for word in ("slot_hole1", "Finger notches", "Inner cuts", "slot cover", "slotted", "divider")]
    [True, True, True, False, False, False]
    """
    tokens = _tokens(word)
    if PART_NAMES & {form for token in tokens for form in (token, token.removesuffix("s"))}:
        return False
    forms = {
        form
        for t in tokens
        for form in (t, t.removesuffix("s"), t.removesuffix("es"), t.removesuffix("e"), t.removesuffix("n"))
    }
    return bool(CUT_NAMES & forms) or any(form in HOLE_WORDS for form in forms)


def is_cut(stroke: Stroke) -> bool:
    """Whether the names of a stroke, or of what it stands in, say that it is cut out of a part."""
    return bool(cut_by(stroke))


def cut_by(stroke: Stroke) -> str:
    """What says that a stroke is cut out of a part: a "hole" in a name of it or of what it stands in, another "name", or nothing."""
    around = (mark for group in stroke.groups for mark in (group.name, *group.marks))
    names = [stroke.label, stroke.name, *stroke.marks, stroke.layer, *around]
    said = [name for name in names if is_cut_name(name)]
    if any(token.startswith(HOLE_WORDS) for name in said for token in _tokens(name)):
        return "hole"
    return "name" if said else ""


@lru_cache(4096)
def _tokens(word: str) -> tuple[str, ...]:
    """Words in small letters without accents; numbers part them."""
    plain = unicodedata.normalize("NFKD", word.lower().replace("ß", "ss").replace("ø", "o"))
    bare = "".join(letter for letter in plain if not unicodedata.combining(letter))
    return tuple(re.findall(r"[^\W\d_]+", bare))


def _words(stroke: Stroke) -> set[str]:
    """Everything that `--only` and `--skip` may call a stroke."""
    marks = [mark for group in stroke.groups for mark in (group.name, *group.marks)]
    colours = [c for colour in (stroke.colour, stroke.fill) if colour for c in (colour, name_of(colour))]
    return {
        word.casefold()
        for word in (stroke.layer, stroke.name, stroke.label, stroke.line_type, *stroke.marks, *marks, *colours)
        if word
    }


def _chosen(artwork: Artwork, options: ReadOptions) -> Callable[[Stroke], str]:
    """Say why the options leave a stroke out, or nothing."""
    known: Counter[str] = Counter(word for stroke in artwork.strokes for word in _words(stroke))
    wrong = []
    asked: dict[str, set[str]] = {}
    for option, names in (("only", options.only), ("skip", options.skip)):
        found = {name.casefold() for name in names} | {colour_of(name) for name in names}
        asked[option] = found
        for name in names:
            elsewhere = option == "skip" and (
                name.startswith("@") or name.casefold() == PAGE
            )  # no stroke, but outlines
            if not elsewhere and not {name.casefold(), colour_of(name)} & set(known):
                shown = [w for w, _ in known.most_common() if not w.startswith("#") or name_of(w) == w]
                near = get_close_matches(name.casefold(), shown, n=3) or shown[:8]
                wrong.append(
                    f"{artwork.file}: --{option} {name}: no layer, colour or name is called so; there is {', '.join(near)}"
                )
    if wrong:
        raise InputError(wrong)

    def reason(stroke: Stroke) -> str:
        words = _words(stroke)
        if asked["skip"] & words:
            return f"of {', '.join(options.skip)} (--skip)"
        if asked["only"] and not asked["only"] & words:
            return f"not of {', '.join(options.only)} (--only)"
        return ""

    return reason


def _usual(artwork: Artwork, stroke: Stroke, visible: bool) -> str:
    """Why a stroke is not cut, by the names and colours around it, or nothing."""
    if any(mark.lower() == LABELS for group in stroke.groups for mark in (group.name, *group.marks)):
        return _SILENT
    if artwork.program == "boxes.py" and stroke.colour in _BOXES_COLOURS:
        return f"{_BOXES_COLOURS[stroke.colour]} (colour {name_of(stroke.colour)} of boxes.py); --only {name_of(stroke.colour)} reads it"
    for group in stroke.groups:
        for mark in dict.fromkeys((group.name, *group.marks)):
            if mark and is_auxiliary_layer(mark):
                return f'in "{mark}", by its name not cut; --only "{mark}" reads it'
    told = stroke.whole or stroke.piece is not None  # the file says that it is a part: its name says nothing else
    for mark in stroke.marks if told else (stroke.label, stroke.name, *stroke.marks):
        if mark and (is_engraved(mark) or NOT_CUT.search(" ".join(_tokens(mark)))):
            return f'called "{mark}", by its name not cut'
    return "" if visible else "without line or fill"


_BOXES_COLOURS = {"#ff0000": "annotations", "#00ff00": "etching", "#00ffff": "deep etching"}
"""What boxes.py draws in these colours."""
_PONOKO, _PONOKO_CUT = "#f6921e", "#0000ff"
"""The frame and the notes of a template of Ponoko, and the lines that are cut on it."""


_MEET = 1e-3
"""Boxes of strokes nearer than this share of the drawing meet."""


def _reference_lines(artwork: Artwork, reasons: list[str]) -> None:
    """Leave out centre lines and hidden edges by their line type, where lines without gaps are there to be cut."""
    rows = [i for i, reason in enumerate(reasons) if not reason]
    if all(artwork.strokes[i].line_type for i in rows):
        return
    for i in rows:
        name = artwork.strokes[i].line_type
        if name and _tokens(name) and _tokens(name)[0].startswith(REFERENCE_LINE_TYPES):
            reasons[i] = f'drawn with line type "{name}", not cut; --only "{name}" reads it'


_SPAN, _SIDES, _TITLES = 0.8, 4, 3
"""The border of a drawing has at least so many lines both ways over this share of its size, and so many texts beside what is drawn."""


def _drawing_border(artwork: Artwork, reasons: list[str]) -> None:
    """Leave out the double frame of a drawing sheet with its title block: one layer or block of straight lines round all others."""
    rows = [i for i, reason in enumerate(reasons) if not reason]
    pools: dict[object, list[int]] = {}
    for i in rows:
        pools.setdefault(artwork.strokes[i].pool, []).append(i)
    if len(artwork.texts) < _TITLES or len(pools) < 2:
        return
    boxes = {i: _box(artwork.strokes[i]) for i in rows}
    whole = shapely.total_bounds(list(boxes.values()))
    for own in pools.values():
        frame = shapely.box(*shapely.total_bounds([boxes[i] for i in own]))
        inner = shapely.box(*shapely.total_bounds([boxes[i] for i in rows if i not in set(own)]))
        if not (frame.bounds == tuple(whole) and shapely.contains_properly(frame, inner)):
            continue
        steps = np.concatenate([np.diff(np.array(trace(path, 4))) for i in own for path in artwork.strokes[i].paths])
        width, height = whole[2:] - whole[:2]
        sides = (np.abs(steps.real) >= _SPAN * width).sum(), (np.abs(steps.imag) >= _SPAN * height).sum()
        titles = shapely.points([(text.at.real, text.at.imag) for text in artwork.texts])
        beside = shapely.intersects(frame, titles) & ~shapely.intersects(inner, titles)
        if min(sides) >= _SIDES and beside.sum() >= _TITLES:
            for i in own:
                reasons[i] = "of the border of a drawing sheet with its title block; --solid all reads it"


def _reference_bar(artwork: Artwork, reasons: list[str]) -> None:
    """Leave out the bar by which the scale of a boxes.py sheet is checked."""
    for lettering in artwork.texts:
        if not _REFERENCE.search(lettering.text):
            continue
        point = shapely.Point(lettering.at.real, lettering.at.imag)
        for i, stroke in enumerate(artwork.strokes):
            if reasons[i] or len(stroke.paths) != 1 or len(stroke.paths[0].segments) > 4:
                continue
            points = np.array(trace(stroke.paths[0], 2))
            box = shapely.box(points.real.min(), points.imag.min(), points.real.max(), points.imag.max())
            if shapely.intersects(box, point):
                reasons[i] = "reference bar of boxes.py"
                break


def _filled(artwork: Artwork, reasons: list[str], options: ReadOptions) -> None:
    """Leave out what is filled without a line of another colour inside outlines that are lines without a fill.

    Red fills are fixed parts, unless they have the colour of lettering or others are left out as well.
    """
    rows = [i for i, reason in enumerate(reasons) if not reason]
    lettered = {s.fill for s, reason in zip(artwork.strokes, reasons, strict=True) if reason and s.fill}
    lines = [i for i in rows if artwork.strokes[i].colour and not artwork.strokes[i].fill]
    fills = [
        i
        for i in rows
        if artwork.strokes[i].fill
        and (artwork.strokes[i].colour in ("", artwork.strokes[i].fill) or is_light(artwork.strokes[i].colour))
        and not _called(artwork.strokes[i], options)
    ]  # fmt: skip
    if not lines or not fills:
        return
    boxes = _boxes_of_outlines([artwork.strokes[i] for i in lines])
    area, tree = shapely.area(boxes), shapely.STRtree(boxes)
    inner = [_box(artwork.strokes[i]) for i in fills]
    fills = [
        i
        for i, box in zip(fills, inner, strict=True)
        if (area[tree.query(box, predicate="covered_by")] > box.area).any()
    ]
    if all(artwork.strokes[i].fixed and artwork.strokes[i].fill not in lettered for i in fills):
        return
    for i in fills:
        reasons[i] = (
            "filled without a line of another colour, among lines: engraving; --solid NAME|all reads it as a part"
        )


def _boxes_of_outlines(strokes: Sequence[Stroke]) -> NDArray[np.object_]:
    """Boxes of strokes, of those that meet together: an outline may be drawn in several."""
    bounds = shapely.bounds([_box(stroke) for stroke in strokes])
    near = _MEET * float(np.ptp(bounds.reshape(-1, 2), axis=0).max())
    low, high = bounds[:, :2] - near, bounds[:, 2:] + near
    return shapely.envelope(shapely.get_parts(shapely.union_all(shapely.box(*low.T, *high.T))))


def _called(stroke: Stroke, options: ReadOptions) -> bool:
    """Whether a person gave a stroke its name, or asked for it as a part."""
    own = {stroke.label, stroke.name}
    return (
        bool(stroke.label)
        or "all" in options.solid
        or bool(own & {*options.solid, *options.hole})
        or has_own_name(stroke)
    )


_AUTOMATIC = re.compile(
    r"(?i)(?:path|rect|circle|ellipse|poly(?:gon|line)|line|g|use|svg|layer|group|shape|object|element|patch|arc|"
    r"curve|compound|clone|xmlid|id|_x?)*[-_ ]*\d[-_\d]*(?:[-_]\d+)*|[0-9a-f]{8}-[0-9a-f-]+|\W*"
)


def has_own_name(stroke: Stroke) -> bool:
    """Whether the id of a stroke is one that a program would not have given."""
    return not _AUTOMATIC.fullmatch(stroke.name)


_BY_PROGRAM = re.compile(r"(?:path|rect|circle|ellipse|polygon|polyline|line|use|g)\d+(?:-\d+)*")


def is_own_label(label: str) -> bool:
    """Whether a person gave a label: one that is the id of a copied element is none.

    Examples
    --------
    >>> is_own_label("lid"), is_own_label("7"), is_own_label("path54-1")
    (True, True, False)
    """
    return bool(label) and not _BY_PROGRAM.fullmatch(label)


def _box(stroke: Stroke) -> shapely.Polygon:
    points = np.array([point for path in stroke.paths for point in trace(path, 4)] or [0j])
    return shapely.box(points.real.min(), points.imag.min(), points.real.max(), points.imag.max())


def _count(n: int) -> str:
    return "1 element" if n == 1 else f"{n} elements"
