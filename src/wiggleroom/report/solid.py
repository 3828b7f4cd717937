"""A free space as a solid that turns under the mouse, as a piece of an HTML page."""

from __future__ import annotations

import json
import math

import numpy as np

from wiggleroom.analysis.audit import about_pivot
from wiggleroom.freespace.space import FreeSpace
from wiggleroom.report import palette
from wiggleroom.report.stack import AZIMUTH, CLEAR, DEEP, ELEVATION, LIGHT, SIZE, extent, heights, outlines
from wiggleroom.report.words import number


def solid(space: FreeSpace) -> str:
    """Solid as HTML with its data; the script that draws it is `SCRIPT`, once a page.

    Without scripts and on paper it is not there; the picture shows the same from one side.
    """
    regions = about_pivot(space)
    low, high = extent(regions)
    middle, scale = (low + high) / 2, SIZE / float((high - low).max())
    box = [((p - middle) * scale).round(1).tolist() for p in (low, high)]
    told = {
        "slices": [[r[:-1].round(1).tolist() for r in outlines(region, middle, scale)] for region in regions],
        "levels": heights(space).round(2).tolist(),
        "rest": int(np.abs([s.angle for s in space.slices]).argmin()),
        "box": box,
        "zero": (-middle * scale).round(1).tolist(),
        "x": f"x {number(float(low[0]), 2)} to {number(float(high[0]), 2)} mm",
        "y": f"y {number(float(low[1]), 2)} to {number(float(high[1]), 2)} mm",
        "angles": [f"{number(math.degrees(a), 3)}°" for a in space.angles],
        "view": [AZIMUTH, ELEVATION],
        "light": LIGHT.tolist(),
        "deep": list(bytes.fromhex(DEEP[1:])),
        "clear": list(bytes.fromhex(CLEAR[1:])),
        "ink": {"grid": palette.GRID, "rest": palette.REST, "quiet": palette.QUIET, "rim": palette.MOTION},
    }
    data = json.dumps(told, separators=(",", ":")).replace("<", "\\u003c")
    return (
        '<div class="solid"><canvas tabindex="0" role="img" '
        'aria-label="the free space as a solid; drag it, or use the arrow keys, to turn it"></canvas>'
        "<p>Drag it, or use the arrow keys, to turn it; a double click turns it back.</p>"
        f'<script type="application/json">{data}</script></div>'
    )


SCRIPT = """
for (const place of document.querySelectorAll('.solid')) {
  const told = JSON.parse(place.querySelector('script').textContent), canvas = place.querySelector('canvas');
  const pen = canvas.getContext('2d'), top = told.levels[told.levels.length - 1];
  const [[left, front], [right, back]] = told.box, corners = [[left, front], [right, front], [right, back], [left, back]];
  const reach = Math.max(...corners.map(p => Math.hypot(...p)));
  let [azimuth, elevation] = told.view;
  function draw() {
    const wide = canvas.clientWidth, high = canvas.clientHeight, fine = devicePixelRatio || 1;
    canvas.width = wide * fine;
    canvas.height = high * fine;
    const zoom = Math.min(wide / (2 * reach + 220), high / (2 * Math.hypot(reach, top / 2) + 50));
    const [c, s] = [Math.cos(azimuth), Math.sin(azimuth)], [ce, se] = [Math.cos(elevation), Math.sin(elevation)];
    const away = (x, y) => s * x + c * y;
    const at = ([x, y], z) => [wide / 2 + zoom * (c * x - s * y), high / 2 - zoom * (se * away(x, y) + ce * (z - top / 2))];
    const trace = (points, z) => {
      points.forEach((p, i) => pen[i ? 'lineTo' : 'moveTo'](...at(p, z)));
      pen.closePath();
    };
    const shade = light => `rgb(${told.deep.map((d, i) => Math.round(d + Math.min(Math.max(light, 0), 1) * (told.clear[i] - d)))})`;
    const path = (make, fill, stroke, width) => {
      pen.beginPath();
      make();
      if (fill) { pen.fillStyle = fill; pen.fill('evenodd'); }
      if (stroke) { pen.strokeStyle = stroke; pen.lineWidth = width || 1; pen.stroke(); }
    };
    function floor() {
      pen.globalAlpha = 0.6;
      path(() => trace(corners, 0), told.ink.grid, told.ink.rest);
      pen.globalAlpha = 1;
      pen.setLineDash([3, 3]);
      const [x, y] = told.zero;
      if (left < x && x < right) path(() => trace([[x, front], [x, back]], 0), null, told.ink.rest);
      if (front < y && y < back) path(() => trace([[left, y], [right, y]], 0), null, told.ink.rest);
      pen.setLineDash([]);
    }
    function prism(k) {
      const [low, up] = [told.levels[k], told.levels[k + 1]], walls = [];
      for (const ring of told.slices[k]) ring.forEach((p, i) => {
        const q = ring[(i + 1) % ring.length], [u, v] = [q[0] - p[0], q[1] - p[1]], long = Math.hypot(u, v) || 1;
        const [nx, ny] = [v / long, -u / long];
        if (away(nx, ny) < 0) walls.push([away(p[0] + q[0], p[1] + q[1]), p, q, 0.62 + 0.3 * (nx * told.light[0] + ny * told.light[1])]);
      });
      walls.sort((a, b) => b[0] - a[0]);
      for (const [, p, q, light] of walls) {
        const colour = shade(light), quad = [at(p, low), at(q, low), at(q, up), at(p, up)];
        path(() => quad.forEach((w, i) => pen[i ? 'lineTo' : 'moveTo'](...w)), colour, colour, 0.6);
      }
      const cap = () => told.slices[k].forEach(ring => trace(ring, se < 0 ? low : up));
      path(cap, shade(se < 0 ? 0.3 : 1), k === told.rest ? told.ink.rim : null, 1.6);
    }
    pen.setTransform(fine, 0, 0, fine, 0, 0);
    pen.lineJoin = 'round';
    const order = told.slices.map((_, k) => k);
    if (se < 0) { order.reverse().forEach(prism); floor(); } else { floor(); order.forEach(prism); }
    const near = corners.map(p => at(p, 0)), post = near.indexOf(near.reduce((a, b) => b[0] < a[0] ? b : a));
    const [px, py] = near[post], rise = at(corners[post], top)[1];
    pen.font = '14px system-ui, sans-serif';
    pen.fillStyle = told.ink.quiet;
    path(() => { pen.moveTo(px - 12, py); pen.lineTo(px - 12, rise); }, null, told.ink.rest);
    pen.fillStyle = told.ink.quiet;
    pen.textAlign = 'right';
    if (Math.abs(py - rise) > 30) told.angles.forEach((a, i) => pen.fillText(a, px - 18, (i ? rise : py) + 5));
    const edge = (a, b, said) => {
      const [x, y] = at([(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], 0);
      pen.textAlign = x < wide / 2 ? 'right' : 'left';
      pen.fillText(said, x + (x < wide / 2 ? -8 : 8), y + (se < 0 ? -12 : 20));
    };
    const ahead = away(0, 1) > 0 ? [0, 1] : [2, 3], aside = away(1, 0) > 0 ? [3, 0] : [1, 2];
    edge(...ahead.map(i => corners[i]), told.x);
    edge(...aside.map(i => corners[i]), told.y);
  }
  const turn = (across, up) => {
    azimuth += across;
    elevation = Math.min(Math.max(elevation + up, -1.5), 1.5);
    draw();
  };
  canvas.addEventListener('pointerdown', e => canvas.setPointerCapture(e.pointerId));
  canvas.addEventListener('pointermove', e => { if (e.buttons) turn(0.008 * e.movementX, 0.008 * e.movementY); });
  canvas.addEventListener('dblclick', () => { [azimuth, elevation] = told.view; draw(); });
  canvas.addEventListener('keydown', e => {
    const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[e.key];
    if (step) { e.preventDefault(); turn(...step); }
  });
  place.classList.add('ready');
  new ResizeObserver(draw).observe(canvas);
}
"""
