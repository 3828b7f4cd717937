/**
 * The hand leads: where a dragged part is drawn before the server has answered.
 *
 * From the last motion that is known to be free it goes towards the pointer, straight and along what it meets, while all others stand:
 * as far as that is free by the outlines themselves. What lies beyond, where others might give way, is a ghost until the answer comes.
 */

import { signal } from "@preact/signals";
import { type Body, slideTowards } from "../collision/sweep.ts";
import { type Outline, outlineOf } from "../collision/outline.ts";
import { fixedNames, groupOf, pose } from "../design.ts";
import { place, shown } from "../motion.ts";
import type { Point } from "../protocol.ts";
import { drawing, extent, indexOf } from "../state.ts";
import { current } from "./now.ts";
import { outOf, placed, type Shape } from "./shapes.ts";

/** Where the hand wants a point of a part, given at rest; `shaped` tells whether the outlines shown are those of the present design. */
export interface Wanted { part: string; grip: Point; target: Point; shaped: boolean }

/** What the hand wants and is not answered yet. */
export const lead = signal<Wanted | null>(null);

/** How parts are led from a motion of all. */
export interface Led {
  /** Shift [mm] that is free by the outlines. */
  free: Point;
  /** Shift at which the grip would be at the pointer. */
  desired: Point;
}

/** Kept between outlines, as a share of the drawing's size: more than they are rounded by on their way here. */
const CLEARANCE = 3e-7;

const outlines = new WeakMap<Shape, Outline>();
function outlined(shape: Shape): Outline {
  let found = outlines.get(shape);
  if (!found) outlines.set(shape, (found = outlineOf(shape.rings)));
  return found;
}

/** Where a drag begins or goes on, the last motion known to be free: what is shown at its end, or rest. */
export function origin(): "pose" | "answer" | "rest" {
  const { what, frames, until } = shown.peek();
  const n = drawing.peek()?.parts.length ?? 0;
  if (frames?.n === n && what === "drag") return pose.peek() ? "pose" : "rest";
  return frames?.n === n && what === "answer" && place.peek() >= 1 && (until ?? 1) === 1 ? "answer" : "rest";
}

/** Parts that move as one with a part. */
export function groupAt(part: string): ReadonlySet<number> {
  return new Set((groupOf(part) ?? [part]).flatMap((name) => indexOf.peek().get(name) ?? []));
}

/** Leads a part, and all that is glued to it, from a motion that is known to be free towards the pointer. */
export function led({ part, grip, target, shaped }: Wanted, motion: Float32Array): Led {
  const at = (k: number) => placed(current.shapes[k]!, motion, k, 1);
  const i = indexOf.peek().get(part)!;
  const shape = current.shapes[i]!;
  const held = outOf(at(i), [grip[0] - shape.at[0], grip[1] - shape.at[1]]);
  const desired: Point = [target[0] - held[0], target[1] - held[1]];
  if (!shaped || (groupOf(part) ?? [part]).some((name) => fixedNames.peek().has(name))) return { free: [0, 0], desired };
  const body = (k: number): Body => ({ ...at(k), outline: outlined(current.shapes[k]!) });
  const group = [...groupAt(part)];
  const moving = group.map(body);
  const free = slideTowards(moving, standing(moving, group, motion, desired).map(body), desired, CLEARANCE * 2 * extent.peek().radius);
  return { free, desired };
}

/** Parts that the moving ones could meet on their path. */
function standing(moving: readonly Body[], group: readonly number[], motion: Float32Array, desired: Point): number[] {
  const far = Math.hypot(...desired);
  const aside = new Set(group);
  for (const pair of drawing.peek()?.ignore ?? []) { // stacked sheets pass each other
    const [a, b] = pair.map((name) => indexOf.peek().get(name)!) as [number, number];
    if (group.length === 1 && group[0] === a) aside.add(b);
    if (group.length === 1 && group[0] === b) aside.add(a);
  }
  const found: number[] = [];
  current.shapes.forEach((shape, k) => {
    if (aside.has(k)) return;
    const [x, y] = [shape.at[0] + motion[3 * k]!, shape.at[1] + motion[3 * k + 1]!];
    if (moving.some((one) => Math.hypot(x - one.x, y - one.y) <= one.outline.radius + shape.radius + far)) found.push(k);
  });
  return found;
}
