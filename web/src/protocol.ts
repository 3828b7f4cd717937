/** What the page and the server say to each other: text frames are objects with a `kind`, binary frames hold motions. */

import type { Design as AnyDesign, GoalEntry, SaveRequest } from "./messages.ts";

export type * from "./messages.ts";

export type Point = [number, number];
export type Ring = Point[];

export type Triple = [number, number, number];

/** Of the plane or of space: then directions, points and turns have three numbers. */
export type Goal = GoalEntry;
export type Pull = Goal & { direction: Point };
export type Turn = Goal & { turn: "cw" | "ccw" };
export type SpatialPull = Goal & { direction: Triple };
export type Twist = Goal & { turn: Triple };
export type Goals = AnyDesign["goals"];
export type Cell = string | readonly string[] | number | null;
export type SaveWhat = SaveRequest["what"];

/** Everything the user set: a page always knows its gap; without `gaps` joints have those of the file. Lengths in mm, angles in degrees. */
export type Design = AnyDesign & { gap: number };

/** Motions of all parts along a path: k frames of n parts, (dx mm, dy mm, turn rad) each; in space (dx, dy, dz mm, quaternion x, y, z, w). */
export interface Frames { k: number; n: number; data: Float32Array }

/** One binary frame: little endian id, k, n, 0, then k*n*3 floats; in space 7 in place of 0 and of 3. */
export function readFrames(buffer: ArrayBuffer): { id: number; frames: Frames } | null {
  if (buffer.byteLength < 16) return null;
  const head = new DataView(buffer);
  const [id, k, n, said] = [0, 4, 8, 12].map((at) => head.getUint32(at, true)) as [number, number, number, number];
  if (k < 1 || (said !== 0 && said !== 7) || buffer.byteLength !== 16 + 4 * k * n * (said || 3)) return null;
  return { id, frames: { k, n, data: new Float32Array(buffer, 16) } };
}

/** Bytes written as base64. */
export function fromBase64(text: string): Uint8Array<ArrayBuffer> {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

export function toBase64(bytes: Uint8Array): string {
  let text = "";
  for (let i = 0; i < bytes.length; i += 0x8000) text += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
  return btoa(text);
}

export const isTurn = (goal: Goal): goal is Turn => typeof goal.turn === "string";
export const isPull = (goal: Goal): goal is Pull => goal.direction?.length === 2;
export const isSpatialPull = (goal: Goal): goal is SpatialPull => goal.direction?.length === 3;
export const isTwist = (goal: Goal): goal is Twist => goal.turn != null && typeof goal.turn !== "string";
