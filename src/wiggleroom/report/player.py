"""A film as a piece of an HTML page: the drawing, play and pause, and a slider along the way."""

from __future__ import annotations

import json

from wiggleroom.report.scene import Scene


def player(made: Scene, *, back: bool) -> str:
    """Scene as HTML with its data; the script that moves it is `SCRIPT`, once a page.

    Parameters
    ----------
    back : bool
        True: playing returns to rest the same way.
    """
    tracks, data = [], []
    for track in made.tracks:
        if track.still:
            tracks.append(track.drawn(0))
            continue
        tracks.append(f'<g class="moves">{track.svg}</g>')
        place = [[round(v, 3) for v in row] for row in track.place.tolist()]
        faded = [round(v, 2) for v in track.opacity.tolist()] if track.opacity.min() < 1 else None
        data.append([place, faded])
    told = json.dumps({"seconds": round(made.seconds, 3), "back": back, "tracks": data}, separators=(",", ":"))
    return (
        f'<div class="film">{made.head}<g clip-path="url(#{made.key}-stage)">{"".join(tracks)}</g></svg>'
        '<div class="controls"><button type="button" aria-label="play or pause">▶</button>'
        '<input type="range" min="0" max="1000" value="0" aria-label="place on the way from rest">'
        '<output>rest</output></div><script type="application/json">' + told.replace("<", "\\u003c") + "</script></div>"
    )


SCRIPT = """
for (const film of document.querySelectorAll('.film')) {
  const told = JSON.parse(film.querySelector('script').textContent);
  const moves = film.querySelectorAll('.moves');
  const button = film.querySelector('button'), slider = film.querySelector('input');
  const said = film.querySelector('output');
  const ease = t => (1 - Math.cos(Math.PI * t)) / 2;
  function show(t) {  // t: share of the playing time, 0 at rest
    told.tracks.forEach(([place, faded], i) => {
      const last = place.length - 1, x = Math.min(t, 1) * last, k = Math.min(Math.floor(x), last - 1), w = x - k;
      const [a, b] = [place[k], place[k + 1]], at = j => a[j] + w * (b[j] - a[j]);
      moves[i].setAttribute('transform', `translate(${at(0)} ${at(1)}) rotate(${at(2)})`);
      if (faded) moves[i].setAttribute('opacity', faded[k] + w * (faded[k + 1] - faded[k]));
    });
    said.textContent = t <= 0 ? 'rest' : Math.round(100 * ease(t)) + ' %';
  }
  let playing = false, clock = 0, before = 0;
  const pause = 0.8, whole = told.seconds;
  const cycle = (told.back ? 2 : 1) * (whole + pause);
  const share = c => Math.max(0, c < whole + pause ? Math.min(c / whole, 1) : 1 - (c - whole - pause) / whole);
  function step(now) {
    if (!playing) return;
    clock = (clock + (now - before) / 1000) % cycle;
    before = now;
    slider.value = Math.round(1000 * share(clock));
    show(share(clock));
    requestAnimationFrame(step);
  }
  function play(on) {
    playing = on;
    button.textContent = on ? '❚❚' : '▶';
    if (on) { before = performance.now(); requestAnimationFrame(step); }
  }
  button.addEventListener('click', () => play(!playing));
  slider.addEventListener('input', () => { play(false); clock = whole * slider.value / 1000; show(slider.value / 1000); });
  show(0);
  film.classList.add('ready');
  const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
  if (!calm) play(true);
}
"""
