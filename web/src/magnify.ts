/** How many times a motion of this drawing is enlarged, so that it can be seen. */

import { autoFactor, fittingFactor, reach } from "./motion.ts";
import type { Frames } from "./protocol.ts";
import { extent, radii } from "./state.ts";

export const reachOf = (frames: Frames): number => reach(frames, radii.peek());

/** Enlarges a motion of this size [mm]; stays with the factor of `now` where that serves. */
export function magnify(size: number, now = autoFactor.peek()): void {
  autoFactor.value = fittingFactor(size, extent.peek().radius, now);
}
