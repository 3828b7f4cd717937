/** What the page and the server say to each other: text frames are objects with a `kind`, binary frames hold motions. */

import type { Design as AnyDesign, PullEntry, SaveRequest } from "./messages.ts";

export type * from "./messages.ts";

export type Point = [number, number];
export type Ring = Point[];

export type Goal = PullEntry;
export type Pull = Goal & { direction: Point };
export type Turn = Goal & { turn: "cw" | "ccw" };
export type Goals = AnyDesign["goals"];
export type Cell = string | readonly string[] | number | null;
export type SaveWhat = SaveRequest["what"];

/** Everything the user set: a page always knows its gap. Lengths in mm, angles in degrees. */
export type Design = AnyDesign & { gap: number };

/** Motions of all parts along a way: k frames of n parts, (dx mm, dy mm, turn rad) each. */
export interface Frames { k: number; n: number; data: Float32Array }

/** One binary frame: little endian id, k, n, 0, then k*n*3 floats. */
export function readFrames(buffer: ArrayBuffer): { id: number; frames: Frames } | null {
  if (buffer.byteLength < 16) return null;
  const head = new DataView(buffer);
  const [id, k, n] = [head.getUint32(0, true), head.getUint32(4, true), head.getUint32(8, true)];
  if (k < 1 || buffer.byteLength !== 16 + 12 * k * n) return null;
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

export const isTurn = (goal: Goal): goal is Turn => "turn" in goal && goal.turn != null;
export const isPull = (goal: Goal): goal is Pull => "direction" in goal && goal.direction != null;
