/** What is on the canvas now, for everything that points at it. */

import { signal } from "@preact/signals";
import { factor } from "../motion.ts";
import type { ContactEntry, Point } from "../protocol.ts";
import { drawing, indexOf } from "../state.ts";
import { size, view } from "./camera.ts";
import type { Spot } from "./marks.ts";
import { hit, into, placed, type Shape } from "./shapes.ts";
import { toWorld } from "./view.ts";

/** Counts the frames painted: what lies over the canvas moves along. */
export const frame = signal(0);
/** Time that the last painted frame took [ms]: where it is too long, thin lines are left out. */
export const cost = { last: 0 };
export const current: { shapes: Shape[]; motion: Float32Array; spots: Spot[] } = { shapes: [], motion: new Float32Array(0), spots: [] };
export const pointerTarget = signal<{ part: string; grip: Point; target: Point } | null>(null);

/** Part under a point of the canvas [px], or null. */
export function partAt(px: Point): string | null {
  const world = toWorld(view.peek(), size.peek(), px);
  const i = hit(current.shapes, current.motion, factor(), world, 5 / view.peek().scale);
  return i < 0 ? null : (drawing.peek()?.parts[i]?.name ?? null);
}

/** The contact whose mark is drawn at a point of the canvas [px], the strongest of several; or null. */
export function contactAt([x, y]: Point, within: number): ContactEntry | null {
  const near = current.spots.filter((one) => Math.hypot(one.x - x, one.y - y) <= within);
  return near.reduce<ContactEntry | null>((best, { contact }) => (best && best.force >= contact.force ? best : contact), null);
}

/** Point of a part at rest that is drawn at a point of the canvas. */
export function gripAt(name: string, px: Point): Point {
  const i = indexOf.peek().get(name)!;
  const shape = current.shapes[i]!;
  const [x, y] = into(placed(shape, current.motion, i, factor()), toWorld(view.peek(), size.peek(), px));
  return [shape.at[0] + x, shape.at[1] + y];
}
