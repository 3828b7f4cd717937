/** Measuring: the clearance between two edges or corners that were picked, as the parts lie now. */

import { signal } from "@preact/signals";
import type { Point } from "../protocol.ts";
import { factor } from "../motion.ts";
import { size, view } from "./camera.ts";
import { current } from "./now.ts";
import { into, outOf, placed } from "./shapes.ts";
import { toWorld } from "./view.ts";

/** An edge of a part, or where both ends are the same a corner, about the part's reference point. */
export interface Feature { part: number; from: Point; to: Point }

export const measuring = signal(false);
export const picked = signal<readonly Feature[]>([]);

/** Corners are taken within this distance [px], edges within that. */
const CORNER = 9;
const EDGE = 12;

/** The nearest corner, or else edge, at a point of the canvas [px]. */
export function featureAt(px: Point): Feature | null {
  const world = toWorld(view.peek(), size.peek(), px);
  const { scale } = view.peek();
  let best: Feature | null = null;
  let least = EDGE / scale;
  current.shapes.forEach((shape, part) => {
    const p = placed(shape, current.motion, part, factor());
    if (Math.hypot(world[0] - p.x, world[1] - p.y) > shape.radius + least) return;
    const at = into(p, world);
    for (const ring of shape.rings) ring.forEach((from, k) => {
      const to = ring[(k + 1) % ring.length]!;
      const corner = Math.hypot(at[0] - from[0], at[1] - from[1]) * (EDGE / CORNER) - 0.5 * EDGE / scale; // corners win where both are near
      if (corner < least) [best, least] = [{ part, from, to: from }, corner];
      const edge = away(at, from, to);
      if (edge < least) [best, least] = [{ part, from, to }, edge];
    });
  });
  return best;
}

/** Picks a feature; a third one begins anew. */
export function pick(px: Point): void {
  const found = featureAt(px);
  if (!found) return;
  picked.value = picked.peek().length === 1 ? [picked.peek()[0]!, found] : [found];
}

export function stopMeasuring(): void {
  measuring.value = false;
  picked.value = [];
}

/** Ends of a feature in the world, its motion times a factor. */
export function ends({ part, from, to }: Feature, times: number): [Point, Point] {
  const p = placed(current.shapes[part]!, current.motion, part, times);
  return [outOf(p, from), outOf(p, to)];
}

/** Shortest segment between two edges or corners: its ends. */
export function shortest([a, b]: readonly [Point, Point], [c, d]: readonly [Point, Point]): [Point, Point] {
  const tries: [Point, Point][] = [[a, foot(a, c, d)], [b, foot(b, c, d)], [foot(c, a, b), c], [foot(d, a, b), d]];
  if (cross(a, b, c, d)) {
    const at = crossing(a, b, c, d);
    return [at, at];
  }
  return tries.reduce((best, one) => (long(one) < long(best) ? one : best));
}

export const long = ([a, b]: readonly [Point, Point]): number => Math.hypot(b[0] - a[0], b[1] - a[1]);

function foot(p: Point, a: Point, b: Point): Point {
  const [ex, ey] = [b[0] - a[0], b[1] - a[1]];
  const square = ex * ex + ey * ey;
  const t = square ? Math.min(Math.max(((p[0] - a[0]) * ex + (p[1] - a[1]) * ey) / square, 0), 1) : 0;
  return [a[0] + t * ex, a[1] + t * ey];
}

const away = (p: Point, a: Point, b: Point): number => long([p, foot(p, a, b)]);
const side = (a: Point, b: Point, p: Point): number => (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
const cross = (a: Point, b: Point, c: Point, d: Point): boolean => side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;

function crossing(a: Point, b: Point, c: Point, d: Point): Point {
  const t = side(c, d, a) / (side(c, d, a) - side(c, d, b));
  return [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
}
