/** How many times a motion of this drawing would have to be enlarged to be seen well. */

import { fittingFactor, reach, suggested } from "./motion.ts";
import type { Frames } from "./protocol.ts";
import { extent, radii } from "./state.ts";

/** What is larger than this share of a drawing's radius is seen as it is: about three pixels. */
const SEEN_WELL = 1 / 130;

/** How far parts that leave are followed [mm]: once round the drawing they are clear of it. */
export const followed = (): number => 3 * extent.peek().radius;

export const reachOf = (frames: Frames): number => reach(frames, radii.peek());

/** Takes note of a motion of this size [mm]; one that is seen at its true size is not to be enlarged. */
export function magnify(size: number): void {
  const { radius } = extent.peek();
  suggested.value = size > radius * SEEN_WELL ? 1 : fittingFactor(size, radius, suggested.peek());
}
