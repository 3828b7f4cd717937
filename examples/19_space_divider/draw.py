"""Draw row.svg and two_rows.svg: `python examples/19_space_divider/draw.py`."""

from pathlib import Path

HERE = Path(__file__).parent
PITCH, UNITS = 56, 12
MARGIN = 20

# Half a side is 28: 12 for the round corner, 11 flat, 5 for half of the mouth of a round knob of radius 7.
# The unit has pockets on the right and at the top, knobs on the left and at the bottom.
UNIT = """M -16,-28 H -5 a 7,7 0 1 0 10,0 H 16 a 12,12 0 0 1 12,12
           V -5 a 7,7 0 1 0 0,10 V 16 a 12,12 0 0 1 -12,12
           H 5 a 7,7 0 1 1 -10,0 H -16 a 12,12 0 0 1 -12,-12
           V 5 a 7,7 0 1 1 0,-10 V -16 a 12,12 0 0 1 12,-12 Z"""
HOLES = ((0, 0, 8.5), (16, 16, 6), (16, -16, 6), (-16, 16, 6), (-16, -16, 6))


def circle(x: float, y: float, r: float) -> str:
    """Circle as a closed subpath."""
    return f"M {x - r},{y} a {r},{r} 0 1 0 {2 * r},0 a {r},{r} 0 1 0 {-2 * r},0 Z"


def svg(rows: int) -> str:
    """Drawing of so many rows of units, the lower left one fixed."""
    wide, high = PITCH * UNITS + 2 * MARGIN, PITCH * rows + 2 * MARGIN
    holes = "\n           ".join(circle(*hole) for hole in HOLES)
    uses = []
    for j in range(rows):
        for i in range(UNITS):
            name, fill = f"{'ab'[j]}{i + 1}", ' fill="red"' if i == j == 0 else ""
            x, y = MARGIN + PITCH * (i + 0.5), MARGIN + PITCH * (rows - j - 0.5)
            uses.append(f'  <use id="{name}" href="#unit" x="{x:g}" y="{y:g}"{fill}/>')
    return f"""<svg xmlns="http://www.w3.org/2000/svg" width="{wide}mm" height="{high}mm" viewBox="0 0 {wide} {high}"
     fill="#e7eaef" stroke="#456" stroke-width="0.4">
  <defs>
    <path id="unit" fill-rule="evenodd"
       d="{UNIT}
           {holes}"/>
  </defs>
{chr(10).join(uses)}
</svg>
"""


if __name__ == "__main__":
    (HERE / "row.svg").write_text(svg(1))
    (HERE / "two_rows.svg").write_text(svg(2))
