/** Choosing many parts: those whose middle lies inside a line that is drawn round them. */

import { signal } from "@preact/signals";
import type { Point } from "../protocol.ts";
import { factor } from "../motion.ts";
import { many, names, selected } from "../state.ts";
import { size, view } from "./camera.ts";
import { current } from "./now.ts";
import { inside, namePlace, outOf, placed } from "./shapes.ts";
import { toScreen } from "./view.ts";

export const lassoing = signal(false);
/** The line so far [px]. */
export const lassoed = signal<readonly Point[]>([]);

export function draw(at: Point): void {
  lassoed.value = [...lassoed.peek(), at];
}

/** Chooses what lies inside; `more` keeps what was chosen before. */
export function close(more: boolean): void {
  const line = [...lassoed.peek()];
  lassoed.value = [];
  if (line.length < 3) return;
  const found = names.peek().filter((_, i) => {
    const shape = current.shapes[i]!;
    const middle = outOf(placed(shape, current.motion, i, factor()), namePlace(shape).at);
    return inside([line], toScreen(view.peek(), size.peek(), middle));
  });
  chooseMany(more ? [...many.peek(), ...found] : found);
}

/** Chooses parts; one alone is chosen as by a press. */
export function chooseMany(found: Iterable<string>): void {
  const all = new Set(found);
  if (all.size > 1) many.value = all;
  else if (many.peek().size) many.value = new Set(); // else nothing changes: a moving hand chooses its part at every frame
  selected.value = all.size === 1 ? [...all][0]! : null;
}

/** Adds a part to those that are chosen, or takes it off. */
export function chooseToo(name: string): void {
  const all = new Set(many.peek().size ? many.peek() : selected.peek() ? [selected.peek()!] : []);
  if (!all.delete(name)) all.add(name);
  chooseMany(all);
}
