/** Outlines of a part as flat arrays, for collision: material lies left of every edge, runs of edges have boxes. */

import type { Ring } from "../protocol.ts";

/** Edge k goes from corner k to corner `next[k]`; run r holds edges 16 r .. 16 r + 15 of `order`, inside its box. */
export interface Outline {
  x: Float64Array;
  y: Float64Array;
  next: Int32Array;
  /** x0, y0, x1, y1 of each run of edges. */
  boxes: Float64Array;
  radius: number;
}

export const RUN = 16;

/** Outline from rings counted even-odd, about the reference point. */
export function outlineOf(rings: readonly Ring[]): Outline {
  const count = rings.reduce((sum, ring) => sum + ring.length, 0);
  const [x, y, next] = [new Float64Array(count), new Float64Array(count), new Int32Array(count)];
  let at = 0;
  let radius = 0;
  rings.forEach((ring, r) => {
    const deep = rings.filter((other, k) => k !== r && within(other, ring[0]!)).length;
    const leftward = area(ring) > 0 === (deep % 2 === 0);
    const corners = leftward ? ring : [...ring].reverse();
    corners.forEach(([px, py], k) => {
      [x[at + k], y[at + k], next[at + k]] = [px, py, at + ((k + 1) % ring.length)];
      radius = Math.max(radius, Math.hypot(px, py));
    });
    at += ring.length;
  });
  const boxes = new Float64Array(4 * Math.ceil(count / RUN));
  for (let r = 0; 4 * r < boxes.length; r++) {
    let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
    for (let k = r * RUN; k < Math.min((r + 1) * RUN, count); k++) for (const c of [k, next[k]!]) {
      [x0, y0, x1, y1] = [Math.min(x0, x[c]!), Math.min(y0, y[c]!), Math.max(x1, x[c]!), Math.max(y1, y[c]!)];
    }
    boxes.set([x0, y0, x1, y1], 4 * r);
  }
  return { x, y, next, boxes, radius };
}

const area = (ring: Ring): number => ring.reduce((sum, [x, y], k) => {
  const [nx, ny] = ring[(k + 1) % ring.length]!;
  return sum + x * ny - nx * y;
}, 0);

function within(ring: Ring, [px, py]: readonly [number, number]): boolean {
  let odd = false;
  ring.forEach(([x, y], k) => {
    const [ox, oy] = ring[(k + 1) % ring.length]!;
    if (y > py !== oy > py && px < ((ox - x) * (py - y)) / (oy - y) + x) odd = !odd;
  });
  return odd;
}
