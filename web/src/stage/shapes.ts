/** Outlines of the parts made ready for drawing and hitting: paths about each part's reference point. */

import type { PartShape, Point, Ring } from "../protocol.ts";
import type { Box } from "./view.ts";

export interface Shape { path: Path2D; rings: Ring[]; at: Point; radius: number; name: NamePlace | null; width: number }

/** One shape a part; `rings` in world coordinates at rest. */
export function shapes(parts: readonly PartShape[], rings: readonly Ring[][]): Shape[] {
  return parts.map((part, i) => shape([part.at[0], part.at[1]], rings[i] ?? part.rings));
}

function shape(at: Point, world: Ring[]): Shape {
  const path = new Path2D();
  let radius = 0;
  let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
  const rings = world.map((ring) => ring.map(([x, y]): Point => [x - at[0], y - at[1]]));
  for (const ring of rings) {
    ring.forEach(([x, y], i) => {
      if (i) path.lineTo(x, y);
      else path.moveTo(x, y);
      radius = Math.max(radius, Math.hypot(x, y));
      [x0, y0, x1, y1] = [Math.min(x0, x), Math.min(y0, y), Math.max(x1, x), Math.max(y1, y)];
    });
    path.closePath();
  }
  return { path, rings, at, radius, name: null, width: x1 - x0 };
}

const ACROSS = 14;

/** Where a name stands, about the reference point, and how wide the material is there [mm]. */
export interface NamePlace { at: Point; room: number }

/** Place for the name: well inside the material, as near to the middle as that allows. Worked out when it is first wanted. */
export function namePlace(shape: Shape): NamePlace {
  if (shape.name) return shape.name;
  const all = shape.rings.flat();
  const [xs, ys] = [all.map((p) => p[0]), all.map((p) => p[1])];
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const middle: Point = [(x0 + x1) / 2, (y0 + y1) / 2];
  const room = (p: Point): number => (inside(shape.rings, p) ? Math.min(...all.map(([x, y]) => Math.hypot(x - p[0], (y - p[1]) * 2)), Infinity) : -1);
  const side = Math.min(x1 - x0, y1 - y0);
  let [best, place] = [room(middle) > side / 8 ? Infinity : -1, middle];
  for (let i = 1; i < ACROSS && best < Infinity; i++) for (let j = 1; j < ACROSS; j++) {
    const p: Point = [x0 + ((x1 - x0) * i) / ACROSS, y0 + ((y1 - y0) * j) / ACROSS];
    const value = room(p) - Math.hypot(p[0] - middle[0], p[1] - middle[1]) / 6;
    if (value > best) [best, place] = [value, p];
  }
  return (shape.name = { at: place, room: widthAt(shape.rings, place) });
}

/** How wide the material is about a point well inside it, as a line through it cuts it [mm]: so long may what is written there be. */
export function widthAt(rings: readonly Ring[], [px, py]: Point): number {
  let [left, right] = [-Infinity, Infinity];
  for (const ring of rings) ring.forEach(([x, y], k) => {
    const [ox, oy] = ring[(k + 1) % ring.length]!;
    if (y > py === oy > py) return;
    const at = x + ((ox - x) * (py - y)) / (oy - y);
    if (at <= px) left = Math.max(left, at);
    else right = Math.min(right, at);
  });
  return Number.isFinite(right - left) ? 2 * Math.min(px - left, right - px) : 0;
}

/** Where a part is: reference point in the world and turn, its motion times the magnification. */
export interface Placed { x: number; y: number; cos: number; sin: number }

export function placed(shape: Pick<Shape, "at">, motion: Float32Array, i: number, factor: number): Placed {
  return posed(
    shape.at[0] + (motion[3 * i] ?? 0) * factor, shape.at[1] + (motion[3 * i + 1] ?? 0) * factor, (motion[3 * i + 2] ?? 0) * factor,
  );
}

export const posed = (x: number, y: number, turn: number): Placed => ({ x, y, cos: Math.cos(turn), sin: Math.sin(turn) });

/** Box around parts at rest and in some motions; on each side no farther out than `most` times the longer side. */
export function around(all: readonly Shape[], rest: Box, motions: readonly Float32Array[], factor: number, most = 0.8): Box {
  let [x0, y0, x1, y1] = rest;
  const far = most * Math.max(x1 - x0, y1 - y0);
  for (const motion of motions) all.forEach((shape, i) => {
    if (!motion[3 * i] && !motion[3 * i + 1] && !motion[3 * i + 2]) return; // where it is at rest
    const p = placed(shape, motion, i, factor);
    for (const ring of shape.rings) for (const point of ring) {
      const [x, y] = outOf(p, point);
      [x0, y0, x1, y1] = [Math.min(x0, x), Math.min(y0, y), Math.max(x1, x), Math.max(y1, y)];
    }
  });
  return [Math.max(x0, rest[0] - far), Math.max(y0, rest[1] - far), Math.min(x1, rest[2] + far), Math.min(y1, rest[3] + far)];
}

/** A vector turned by an angle [rad]. */
export const turned = ([x, y]: Point, angle: number): Point => [Math.cos(angle) * x - Math.sin(angle) * y, Math.sin(angle) * x + Math.cos(angle) * y];

/** World point as seen from the part, about its reference point. */
export const into = (p: Placed, [x, y]: Point): Point => [
  p.cos * (x - p.x) + p.sin * (y - p.y),
  -p.sin * (x - p.x) + p.cos * (y - p.y),
];
export const outOf = (p: Placed, [x, y]: Point): Point => [p.x + p.cos * x - p.sin * y, p.y + p.sin * x + p.cos * y];

/** Whether a point about the reference point lies in the rings, counted even-odd. */
export function inside(rings: readonly Ring[], [px, py]: Point): boolean {
  let odd = false;
  for (const ring of rings) {
    for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
      const [xi, yi] = ring[i]!;
      const [xj, yj] = ring[j]!;
      if (yi > py !== yj > py && px < ((xj - xi) * (py - yi)) / (yj - yi) + xi) odd = !odd;
    }
  }
  return odd;
}

/** Index of the part at a world point, the one drawn last where several are; -1 for none. `slack` [mm] helps thin parts. */
export function hit(all: readonly Shape[], motion: Float32Array, factor: number, at: Point, slack: number): number {
  let near = -1;
  let best = slack;
  for (let i = all.length - 1; i >= 0; i--) {
    const one = all[i]!;
    const p = placed(one, motion, i, factor);
    const away = Math.hypot(at[0] - p.x, at[1] - p.y);
    if (away > one.radius + slack) continue;
    const local = into(p, at);
    if (inside(one.rings, local)) return i;
    for (const ring of one.rings) for (const [x, y] of ring) {
      const d = Math.hypot(x - local[0], y - local[1]);
      if (d < best) [best, near] = [d, i];
    }
  }
  return near;
}
