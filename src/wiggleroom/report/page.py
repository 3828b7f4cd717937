"""One-file HTML pages: no request leaves the page, light and dark, good on paper; what users name is escaped."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from wiggleroom.report import palette
from wiggleroom.report.player import SCRIPT as PLAYER
from wiggleroom.report.solid import SCRIPT as SOLID
from wiggleroom.report.text import escape

Cell = str | float | int


@dataclass(frozen=True)
class Section:
    """A heading and what stands under it.

    Parameters
    ----------
    heading : str
    body : str
        HTML, made by the functions of this module.
    wide : bool
        True: it takes the whole width of the page.
    """

    heading: str
    body: str
    wide: bool = False


def page(title: str, facts: Sequence[str], sections: Sequence[Section], command: str = "") -> str:
    """Whole HTML document.

    Parameters
    ----------
    title, facts, command : str, sequence of str, str
        Plain text.
    sections : sequence of Section

    Examples
    --------
    >>> "<h1>a &lt; b</h1>" in page("a < b", [], [Section("Parts", table(["part"], [["a"]]))])
    True
    """
    chips = "".join(f"<li>{escape(f)}</li>" for f in facts)
    body = "".join(
        f"<section{' class=wide' if s.wide else ''}><h2>{escape(s.heading)}</h2>{s.body}</section>" for s in sections
    )
    solid = SOLID if 'class="solid"' in body else ""
    made = f"<footer>Made by<pre><code>{escape(command)}</code></pre></footer>" if command else ""
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
        "script-src 'unsafe-inline'; img-src data:\">"
        f'<link rel="icon" href="data:,"><title>{escape(title)}</title><style>{_STYLE}</style></head>\n'
        f"<body><header><h1>{escape(title)}</h1><ul>{chips}</ul></header>\n<main>{body}</main>\n{made}"
        f"<script>{PLAYER}{solid}{_SORTING}</script></body></html>\n"
    )


def table(columns: Sequence[str], rows: Sequence[Sequence[Cell]], *, most: int = 2000) -> str:
    """Table that sorts by a click on a column's head; numbers are set to the right.

    Parameters
    ----------
    rows : sequence of rows
        Text or numbers; numbers are shown with the same decimals and sorted by their full value.
    most : int
        Rows that are shown; a line says how many more there are.
    """
    if not rows:
        return "<p>none</p>"
    places = [_places([row[k] for row in rows]) for k in range(len(columns))]
    heads = "".join(
        f'<th scope="col"{"" if p is None else " class=n"}><button type="button">{escape(c)}</button></th>'
        for c, p in zip(columns, places, strict=True)
    )
    lines = "".join(
        "<tr>" + "".join(_cell(c, p) for c, p in zip(row, places, strict=True)) + "</tr>" for row in rows[:most]
    )
    left = f"<p>and {len(rows) - most} more</p>" if len(rows) > most else ""
    return f'<div class="scroll"><table><thead><tr>{heads}</tr></thead><tbody>{lines}</tbody></table></div>{left}'


def figure(svg: str, caption: str = "", *, paper: bool = False) -> str:
    """Picture, drawn as part of the page; on white `paper` also in the dark, where its colours mean something."""
    drawing = svg[svg.index("<svg") :]
    return f"<figure{' class=paper' if paper else ''}>{drawing}{f'<figcaption>{escape(caption)}</figcaption>' if caption else ''}</figure>"


def items(pairs: Sequence[tuple[str, str]]) -> str:
    """List of terms and what is said about each."""
    return "<dl>" + "".join(f"<dt>{escape(a)}</dt><dd>{escape(b)}</dd>" for a, b in pairs) + "</dl>"


def _places(column: Sequence[Cell]) -> int | None:
    """Decimals that show four digits of a column's largest number; None for text."""
    values = [abs(float(c)) for c in column if not isinstance(c, str)]
    if not values:
        return None
    largest = max((v for v in values if math.isfinite(v)), default=0.0)
    if largest == 0 or all(isinstance(c, int) for c in column):
        return 0
    return min(max(3 - math.floor(math.log10(largest)), 0), 9)


def _cell(value: Cell, places: int | None) -> str:
    if isinstance(value, str):
        return f"<td>{escape(value)}</td>"
    if math.isfinite(value):
        return f'<td class="n" data-v="{value!r}">{value + 0.0:.{places or 0}f}</td>'
    sign, shown = ("", "∞") if value > 0 else ("-", "-∞" if value < 0 else "–")  # what is not known sorts as the least
    return f'<td class="n" data-v="{sign}Infinity">{shown}</td>'


# The pictures carry their colours as attributes; rules by attribute turn them over in the dark.
_DARK = "".join(
    f':is(figure:not(.paper),.film) svg [{kind}="{light}"]{{{kind}:{dark}}}'
    for light, dark in (
        (palette.PAPER, "#161b22"),
        (palette.INK, "#e6e9ed"),
        (palette.QUIET, "#a3adb8"),
        (palette.REST, "#59636e"),
        (palette.GRID, "#2a313a"),
        (palette.NEUTRAL[0], "#3a4450"),
        (palette.NEUTRAL[1], "#93a0ad"),
        (palette.PULLED[0], "#2c6ca8"),
        (palette.PULLED[1], "#9ccbf2"),
        (palette.FIXED[0], "#a84a3f"),
        (palette.FIXED[1], "#f3aaa1"),
        (palette.MOTION, "#d6ebff"),
        (palette.FORCE, "#ffb25c"),
    )
    for kind in ("fill", "stroke")
)

_STYLE = f"""
:root{{--paper:#fff;--ink:{palette.INK};--quiet:{palette.QUIET};--line:#dde2e7;--page:#f5f6f8;--accent:{palette.PULLED[1]}}}
*{{box-sizing:border-box}}
body{{margin:0 auto;max-width:1240px;padding:32px 24px;background:var(--page);color:var(--ink);
font:16px/1.5 system-ui,{palette.FONT}}}
h1{{font-size:30px;line-height:1.2;margin:0 0 8px;font-weight:600;overflow-wrap:anywhere}}
h2{{font-size:15px;margin:0 0 10px;color:var(--quiet);font-weight:600}}
header ul{{list-style:none;display:flex;flex-wrap:wrap;gap:8px;margin:0 0 24px;padding:0}}
header li{{border:1px solid var(--line);background:var(--paper);border-radius:99px;padding:2px 12px;font-size:14px;
overflow-wrap:anywhere}}
main{{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,430px),1fr));gap:20px;align-items:start}}
section{{background:var(--paper);border:1px solid var(--line);border-radius:12px;padding:18px;min-width:0}}
section.wide{{grid-column:1/-1}}
figure{{margin:0}}.paper svg{{border-radius:8px}}svg{{display:block;width:100%;height:auto;max-height:85vh}}
.controls{{display:none;gap:12px;align-items:center;margin-top:10px}}.ready .controls{{display:flex}}
.controls input{{flex:1;accent-color:var(--accent);min-width:0}}
.controls button{{width:44px;height:36px;border-radius:8px;border:1px solid var(--line);background:none;color:inherit;
font:inherit;cursor:pointer}}
.controls output{{width:4em;text-align:right;font-variant-numeric:tabular-nums}}
.solid{{display:none}}.solid.ready{{display:block}}
.solid canvas{{display:block;width:100%;height:min(460px,70vh);background:{palette.PAPER};border-radius:8px;cursor:grab;touch-action:pan-y}}
.solid canvas:active{{cursor:grabbing}}.solid p{{margin:8px 0 0;color:var(--quiet);font-size:14px}}
.scroll{{max-height:430px;overflow:auto}}
table{{border-collapse:collapse;width:100%;font-size:14px}}
thead th{{position:sticky;top:0;background:var(--paper);padding:0;border-bottom:1px solid var(--line)}}
th button{{all:unset;box-sizing:border-box;width:100%;text-align:left;
cursor:pointer;display:block;padding:6px 10px;font-weight:600;color:var(--quiet);white-space:nowrap}}
th button:focus-visible{{outline:2px solid var(--accent);outline-offset:-2px}}
th[aria-sort=ascending] button::after{{content:" ▲"}}th[aria-sort=descending] button::after{{content:" ▼"}}
td{{padding:5px 10px;border-bottom:1px solid var(--line);overflow-wrap:anywhere}}
th.n button{{text-align:right}}
td.n{{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}}
dl{{display:grid;grid-template-columns:auto 1fr;gap:4px 16px;margin:0;font-size:15px}}
dt{{color:var(--quiet)}}dd{{margin:0;overflow-wrap:anywhere}}
footer{{color:var(--quiet);margin-top:24px;font-size:14px}}
pre{{white-space:pre-wrap;overflow-wrap:anywhere;background:var(--paper);border:1px solid var(--line);border-radius:8px;
padding:10px 14px;color:var(--ink)}}
@media screen and (prefers-color-scheme:dark){{
:root{{--paper:#161b22;--ink:#e6e9ed;--quiet:#a3adb8;--line:#2d343d;--page:#0d1117;--accent:#9ccbf2;color-scheme:dark}}
{_DARK}}}
@media print{{body{{background:#fff;padding:0;max-width:none}}main{{display:block}}
section{{border:0;padding:0;margin:0 0 18px}}.film,.controls,.solid{{display:none!important}}
section:has(.film,.solid){{display:none}}.scroll{{max-height:none;overflow:visible}}svg{{max-height:200mm}}
tr,figure{{break-inside:avoid}}h2{{break-after:avoid}}}}
"""

_SORTING = """
for (const head of document.querySelectorAll('thead th')) {
  head.querySelector('button').addEventListener('click', () => {
    const body = head.closest('table').tBodies[0], column = head.cellIndex;
    const key = row => { const c = row.cells[column]; return c.dataset.v === undefined ? c.textContent : +c.dataset.v; };
    const number = body.rows[0].cells[column].dataset.v !== undefined;
    const was = head.getAttribute('aria-sort');
    const down = was ? was === 'ascending' : number;
    for (const other of head.parentNode.cells) other.removeAttribute('aria-sort');
    head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
    const order = [...body.rows].sort((a, b) => {
      const [x, y] = [key(a), key(b)];
      if (typeof x === 'number' && typeof y === 'number') return x === y ? 0 : x - y;
      return String(x).localeCompare(String(y), undefined, {numeric: true});
    });
    body.append(...(down ? order.reverse() : order));
  });
}
"""
