"""Draw the three shelves: `python examples/14_shelf/draw.py`."""

from pathlib import Path

HERE = Path(__file__).parent
SHEET, SLOT, SIDE_PLAY = 2.8, 3.0, 0.6
SHELF_PLAYS = (0.0, 0.5, 1.5)
WIDE, HIGH = 160.0, 150.0
SIDES = {"left": 20.0, "right": 140.0}
SHELVES = {"bottom": 25.0, "middle": 75.0, "top": 125.0}
ABOVE = 4.4
"""The cheeks of a shelf's slots are drawn so far above the sheet: at the sheet's own height the plane is taken."""


def rect(x: float, y: float, wide: float, high: float) -> str:
    """Rectangle as a subpath, from its lower left corner, y pointing up."""
    return f"M{x:g},{HIGH - y:g} h{wide:g} v{-high:g} h{-wide:g} Z"


def side(name: str, x: float) -> list[str]:
    """Pieces of a side between its slots, each a part: they are glued."""
    slot = SLOT + SIDE_PLAY
    ends = [0.0, *[y + s * slot / 2 for y in SHELVES.values() for s in (-1, 1)], HIGH]
    pieces = enumerate(zip(ends[::2], ends[1::2], strict=True))
    paths = [
        f'    <path id="{name}{f"-{k}" if k else ""}" d="{rect(x - SHEET / 2, low, SHEET, high - low)}"/>'
        for k, (low, high) in pieces
    ]
    return [f'  <g id="glue-{name}">', *paths, "  </g>"]


def shelf(name: str, y: float, slot: float) -> list[str]:
    """One part of five pieces: the sheet, and the cheeks of its slots."""
    cheeks = [
        rect(x + s * slot / 2 - (SHEET if s < 0 else 0), y + ABOVE - SHEET / 2, SHEET, SHEET)
        for x in SIDES.values()
        for s in (-1, 1)
    ]
    pieces = " ".join([rect(0.0, y - SHEET / 2, WIDE, SHEET), *cheeks])
    red = ' fill="red"' if name == "bottom" else ""
    return [f'  <path id="{name}"{red} d="{pieces}"/>']


def svg(play: float) -> str:
    """Cross-section of a shelf whose own slots have so much play."""
    body = [line for name, x in SIDES.items() for line in side(name, x)]
    body += [line for name, y in SHELVES.items() for line in shelf(name, y, SLOT + play)]
    size = f'width="{WIDE:g}mm" height="{HIGH:g}mm" viewBox="0 0 {WIDE:g} {HIGH:g}"'
    return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" {size} fill="#e7eaef">', *body, "</svg>"]) + "\n"


if __name__ == "__main__":
    for play in SHELF_PLAYS:
        (HERE / f"shelf_{play:g}.svg").write_text(svg(play))
