/** Where one part is in another's frame, against rest, seen at a point that turns with it. */

import type { PartShape, Point } from "../protocol.ts";
import { into, outOf, type Placed, placed, turned } from "../stage/shapes.ts";

/** Motion of the pivot of b in a's frame, and turn [mm, mm, degrees], from the motions of all parts. */
export function relative(parts: readonly PartShape[], a: string, b: string, motion: Float32Array, pivot: Point): [number, number, number] {
  const [i, j] = [a, b].map((name) => parts.findIndex((part) => part.name === name)) as [number, number];
  if (i < 0 || j < 0) return [0, 0, 0];
  const at = (k: number): Point => [parts[k]!.at[0], parts[k]!.at[1]];
  const now = (k: number): Placed => placed({ at: at(k) }, motion, k, 1);
  const axes = (parts[i]!.at[2] * Math.PI) / 180;
  const grip = turned(pivot, axes);
  const seen = into(now(i), outOf(now(j), grip)); // the pivot as a sees it, about a's reference point
  const away: Point = [seen[0] - (at(j)[0] + grip[0] - at(i)[0]), seen[1] - (at(j)[1] + grip[1] - at(i)[1])];
  const turn = (motion[3 * j + 2] ?? 0) - (motion[3 * i + 2] ?? 0);
  return [...turned(away, -axes), (turn * 180) / Math.PI];
}
