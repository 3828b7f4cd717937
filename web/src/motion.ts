/** What the canvas shows: frames along a path, a place on it, playing, magnification, and a soft change from one to the next. */

import { effect, signal } from "@preact/signals";
import type { Frames } from "./protocol.ts";

export type What = "rest" | "answer" | "between" | "drag" | "mode" | "escape";
export interface Shown {
  what: What; frames: Frames | null; label: string; back: boolean;
  /** Share of the frames that is shown: parts that leave are followed until they are clear, not for ever. */
  until?: number;
  /** What comes when it has played to its end; else it plays again. */
  next?: () => void;
}

const REST: Shown = { what: "rest", frames: null, label: "", back: false };
const BLEND = 170;
const PAUSE = 700;

/** Magnifications. */
export const FACTORS = [1, 2, 5, 10, 20, 50, 100];
/** What is smaller than this share of a drawing's radius is not seen: about a pixel. */
const SEEN = 1 / 400;

export const shown = signal<Shown>(REST);
export const place = signal(1);
export const playing = signal(false);
/** Chosen magnification: parts that touch are drawn through each other by it, so that nobody but the user sets it. */
export const chosenFactor = signal(1);
/** The one that would show the motion well. */
export const suggested = signal(1);

export const factor = (): number => chosenFactor.value;
export const calm = (): boolean => typeof matchMedia === "function" && matchMedia("(prefers-reduced-motion: reduce)").matches;

/** Numbers that a part has in every frame: 3 in the plane, 7 in space. */
export const columns = ({ k, n, data }: Frames): number => data.length / (k * n);

/** Motions between two, written into `out`: in the plane linear; in space positions go straight and turns about one constant axis. */
function mix(a: Float32Array, from: number, b: Float32Array, to: number, w: number, width: number, out: Float32Array): Float32Array {
  for (let i = 0; i < out.length; i++) out[i] = a[from + i]! + w * (b[to + i]! - a[from + i]!);
  if (width !== 7) return out;
  for (let q = 3; q < out.length; q += 7) {
    let dot = 0;
    for (let j = 0; j < 4; j++) dot += a[from + q + j]! * b[to + q + j]!;
    const sign = dot < 0 ? -1 : 1;
    const angle = Math.acos(Math.min(1, Math.abs(dot)));
    const sine = Math.sin(angle);
    const [u, v] = sine < 1e-5 ? [1 - w, w] : [Math.sin((1 - w) * angle) / sine, Math.sin(w * angle) / sine];
    let long = 0;
    for (let j = 0; j < 4; j++) {
      out[q + j] = u * a[from + q + j]! + v * sign * b[to + q + j]!;
      long += out[q + j]! ** 2;
    }
    for (let j = 0; j < 4; j++) out[q + j]! /= Math.sqrt(long) || 1;
  }
  return out;
}

/** Motion at a place `t` in 0..1 along the frames, written into `out`. */
export function along(frames: Frames, t: number, out?: Float32Array): Float32Array {
  const { k, n, data } = frames;
  const width = columns(frames);
  const x = Math.min(Math.max(t, 0), 1) * (k - 1);
  const low = Math.min(Math.floor(x), Math.max(k - 2, 0));
  return mix(data, low * n * width, data, Math.min(low + 1, k - 1) * n * width, x - low, width, out ?? new Float32Array(n * width));
}

/** Motions of the parts that do not rest, by name. */
export function poseOf(motion: Float32Array, names: readonly string[], width: number): Record<string, number[]> {
  const rests = (one: Float32Array): boolean => one.every((v, k) => v === (k === 6 ? 1 : 0));
  return Object.fromEntries(names.flatMap((name, i) => {
    const one = motion.subarray(width * i, width * (i + 1));
    return rests(one) ? [] : [[name, [...one]] as const];
  }));
}

/** The same as motions of all parts. */
export function motionOf(pose: Readonly<Record<string, readonly number[]>>, names: readonly string[], width: number): Float32Array {
  const out = new Float32Array(names.length * width);
  names.forEach((name, i) => {
    const one = Object.hasOwn(pose, name) ? pose[name]! : [];
    if (one.length === width) out.set(one, width * i);
    else if (width === 7) out[7 * i + 6] = 1;
  });
  return out;
}

/** At most so many of the frames, first and last among them. */
export function sampled(frames: Frames, most: number, until = 1): Float32Array[] {
  const count = Math.min(frames.k, most);
  return Array.from({ length: count }, (_, i) => along(frames, until * (count > 1 ? i / (count - 1) : 1)));
}

/** Share of the frames after which a part has gone so far [mm]; 1 where none does. */
export function shareWithin(frames: Frames, far: number): number {
  const { k, n, data } = frames;
  const width = columns(frames);
  let before = 0;
  for (let f = 0; f < k; f++) {
    let gone = 0;
    for (let i = 0; i < n; i++) gone = Math.max(gone, farOf(data, f * n + i, width));
    if (gone > far) return f ? (f - 1 + (far - before) / (gone - before)) / (k - 1) : 1;
    before = gone;
  }
  return 1;
}

/** Last frame alone. */
export const end = (frames: Frames): Float32Array => frames.data.slice((frames.k - 1) * frames.n * columns(frames));

/** Motion between two solved gaps; null elsewhere: beyond what was solved nothing is known. */
export function between(solved: readonly { gap: number; end: Float32Array | null }[], gap: number, width = 3): Float32Array | null {
  const upper = solved.findIndex((one) => one.gap >= gap);
  const above = solved[upper];
  if (above?.end && Math.abs(above.gap - gap) < 1e-12) return above.end;
  const below = solved[upper - 1];
  if (!above?.end || !below?.end) return null;
  const w = (gap - below.gap) / (above.gap - below.gap);
  return mix(below.end, 0, above.end, 0, w, width, new Float32Array(above.end.length));
}

/** The same for a number. */
export function valueBetween(solved: readonly { gap: number; objective: number | null }[], gap: number): number | null {
  const upper = solved.findIndex((one) => one.gap >= gap);
  const above = solved[upper];
  if (above && Math.abs(above.gap - gap) < 1e-12) return above.objective;
  const below = solved[upper - 1];
  if (above?.objective == null || below?.objective == null) return null;
  return below.objective + ((gap - below.gap) / (above.gap - below.gap)) * (above.objective - below.objective);
}

/** Factor from a row of round numbers that makes a motion of `size` visible in a drawing of `radius`; keeps `now` where that serves. */
export function fittingFactor(size: number, radius: number, now = 1): number {
  if (size * FACTORS.at(-1)! < radius * SEEN) return 1;
  const good = (f: number): boolean => (f === 1 || size * f < radius / 3) && size * f > radius / 25;
  if (good(now)) return now;
  let best = 1;
  for (const f of FACTORS.slice(1)) if (size * best < radius / 12 && size * f < radius / 4) best = f;
  return best;
}

/** How far any corner goes in the last frame, at most [mm]; `radii` of the parts about their reference points [mm]. */
export function reach(frames: Frames, radii: readonly number[]): number {
  const last = end(frames);
  const width = columns(frames);
  let most = 0;
  for (let i = 0; i < frames.n; i++) most = Math.max(most, farOf(last, i, width) + (radii[i] ?? 0) * turnOf(last, i, width));
  return most;
}

/** How far a part goes in a motion [mm]. */
export const farOf = (motion: Float32Array, i: number, width: number): number => Math.hypot(...motion.subarray(width * i, width * i + (width === 7 ? 3 : 2)));

/** How far a part turns in a motion [rad]. */
export function turnOf(motion: Float32Array, i: number, width: number): number {
  if (width === 3) return Math.abs(motion[3 * i + 2]!);
  const [x, y, z, w] = motion.subarray(7 * i + 3, 7 * i + 7) as unknown as [number, number, number, number];
  return 2 * Math.atan2(Math.hypot(x, y, z), Math.abs(w));
}

/** Shows something else from now on; `soft` changes over a few frames. */
export function show(next: Shown, soft = true): void {
  playing.value = false;
  from = soft && !calm() && displayed.length > 0 ? displayed.slice() : null;
  since = performance.now();
  shown.value = next;
  place.value = 1;
}

/** Shows the parts at rest. */
export function showRest(soft = true): void {
  suggested.value = 1; // nothing moves
  show(REST, soft);
}

/** Shows the path of an answer at its end; where parts leave it plays, for at the end they are gone. */
export function showAnswer(frames: Frames, leaves: boolean, far: number, soft = true): void {
  show({ what: "answer", frames, label: "", back: !leaves, ...(leaves && { until: shareWithin(frames, far) }) }, soft);
  if (leaves && !calm()) play(true);
}

export function play(on: boolean): void {
  if (!shown.value.frames || shown.value.frames.k < 2) return;
  playing.value = on;
}

let displayed = new Float32Array(0);
let from: Float32Array | null = null;
let since = 0;
let clock = 0;
let before = 0;
effect(() => {
  if (!playing.value) return;
  before = performance.now();
  clock = (place.peek() >= 1 ? 0 : place.peek()) * seconds();
});

const seconds = (): number => (shown.peek().what === "mode" ? 2400 : 1800);

/** Motions of `n` parts to draw now, of so many numbers each, and whether the picture goes on changing. */
export function pose(now: number, n: number, width = 3): { motion: Float32Array; moving: boolean } {
  const { back } = shown.peek();
  if (displayed.length !== n * width) {
    displayed = new Float32Array(n * width);
    from = null;
  }
  if (playing.peek()) advance(now, back);
  const { frames } = shown.peek();
  if (frames && frames.data.length === frames.k * n * width) along(frames, place.peek() * (shown.peek().until ?? 1), displayed);
  else {
    displayed.fill(0);
    if (width === 7) for (let q = 6; q < displayed.length; q += 7) displayed[q] = 1;
  }
  const w = from && from.length === displayed.length ? (now - since) / BLEND : 1;
  if (w >= 1) from = null;
  else {
    const eased = 1 - (1 - Math.max(w, 0)) ** 3;
    mix(from!, 0, displayed.slice(), 0, eased, width, displayed);
  }
  return { motion: displayed, moving: playing.peek() || from !== null };
}

function advance(now: number, back: boolean): void {
  const whole = seconds();
  const loop = shown.peek().what === "mode";
  const cycle = loop ? whole : (back ? 2 : 1) * (whole + PAUSE);
  clock += Math.min(now - before, 100);
  before = now;
  const { next } = shown.peek();
  if (clock >= cycle && next) {
    next();
    place.value = 0;
    return;
  }
  clock %= cycle;
  place.value = loop || clock < whole + PAUSE ? Math.min(clock / whole, 1) : Math.max(0, 1 - (clock - whole - PAUSE) / whole);
}
