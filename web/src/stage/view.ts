/** Which part of the plane the canvas shows: the point in its middle and pixels per mm; y points up in the plane, down on the screen. */

import type { Point } from "../protocol.ts";

export interface View { x: number; y: number; scale: number }
export interface Size { width: number; height: number }
/** Room that other things cover at the edges of the canvas [px]. */
export interface Inset { top: number; right: number; bottom: number; left: number }

/** x0, y0, x1, y1. */
export type Box = readonly [number, number, number, number];

export const toScreen = (v: View, s: Size, [x, y]: Point): Point => [s.width / 2 + (x - v.x) * v.scale, s.height / 2 - (y - v.y) * v.scale];
export const toWorld = (v: View, s: Size, [x, y]: Point): Point => [v.x + (x - s.width / 2) / v.scale, v.y - (y - s.height / 2) / v.scale];

/** View in which a box [x0, y0, x1, y1] fills what is not covered. */
export function fit([x0, y0, x1, y1]: Box, s: Size, inset: Inset): View {
  const width = Math.max(s.width - inset.left - inset.right, 40);
  const height = Math.max(s.height - inset.top - inset.bottom, 40);
  const scale = Math.min(width / Math.max(x1 - x0, 1e-9), height / Math.max(y1 - y0, 1e-9));
  const [right, down] = [(inset.left - inset.right) / 2, (inset.top - inset.bottom) / 2];
  return { x: (x0 + x1) / 2 - right / scale, y: (y0 + y1) / 2 + down / scale, scale };
}

/** View after zooming by a factor with the plane's point under `at` [px] staying where it is. */
export function zoomed(v: View, s: Size, at: Point, factor: number): View {
  const [x, y] = toWorld(v, s, at);
  const scale = v.scale * factor;
  return { x: x - (at[0] - s.width / 2) / scale, y: y + (at[1] - s.height / 2) / scale, scale };
}

export const panned = (v: View, dx: number, dy: number): View => ({ ...v, x: v.x - dx / v.scale, y: v.y + dy / v.scale });
