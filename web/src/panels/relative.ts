/** Where one part is in another's frame, against rest, seen at a point that turns with it. */

import type { PartShape, Point } from "../protocol.ts";

/** Motion of the pivot of b in a's frame, and turn [mm, mm, degrees], from the motions of all parts. */
export function relative(parts: readonly PartShape[], a: string, b: string, motion: Float32Array, pivot: Point): [number, number, number] {
  const [i, j] = [a, b].map((name) => parts.findIndex((part) => part.name === name));
  if (i! < 0 || j! < 0) return [0, 0, 0];
  const [A, B] = [parts[i!]!.at, parts[j!]!.at];
  const m = (k: number, axis: number): number => motion[3 * k + axis] ?? 0;
  const back = (x: number, y: number, angle: number): [number, number] => [
    Math.cos(angle) * x + Math.sin(angle) * y, -Math.sin(angle) * x + Math.cos(angle) * y,
  ];
  const rest = (A[2] * Math.PI) / 180;
  const now = back(B[0] + m(j!, 0) - A[0] - m(i!, 0), B[1] + m(j!, 1) - A[1] - m(i!, 1), rest + m(i!, 2));
  const then = back(B[0] - A[0], B[1] - A[1], rest);
  const turn = m(j!, 2) - m(i!, 2);
  const swung = back(pivot[0], pivot[1], -turn);
  return [now[0] - then[0] + swung[0] - pivot[0], now[1] - then[1] + swung[1] - pivot[1], (turn * 180) / Math.PI];
}
