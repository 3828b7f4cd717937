/** What the page and the server say to each other: text frames are objects with a `kind`, binary frames hold motions. */

export type Point = [number, number];
export type Ring = Point[];

export interface Pull { part: string; direction: Point; point?: Point; weight?: number }
export interface Turn { part: string; turn: "cw" | "ccw"; weight?: number }
export interface Weights { part: string; w: [number, number, number]; weight?: number }
export type Goal = Pull | Turn | Weights;
export type Goals = Goal[] | "translation" | "closer";

/** Everything the user set. Lengths in mm, angles in degrees. */
export interface Design {
  gap: number;
  extra: Record<string, number>;
  fixed: string[];
  glue: string[][];
  goals: Goals;
}

export interface PartShape { name: string; at: [number, number, number]; rings: Ring[] }

export interface Opened {
  kind: "opened"; id: number; name: string; gap: number; unit: string; notes: string[];
  size: [number, number, number, number];
  parts: PartShape[]; design: Design; pulled?: Goal | Goal[] | null;
}

export interface Contact { parts: [string, string]; point: Point; normal: Point; force: number }

export interface FlexReply {
  kind: "flex"; id: number; objective: number | null; verdict: string; headline: string; facts: string[];
  sure: [string, string][]; at_most: number | null; leaves: string[]; turns?: string[]; contacts: Contact[];
  collision_free: boolean; path: string; seconds: Record<string, number> | number;
  rings?: Ring[][]; settled: boolean; command: string;
}
export interface DragReply {
  kind: "drag"; id: number; part: string; target: Point; reached: Point; distance: number;
  held: Contact[]; blocking: string[]; settled: boolean; rings?: Ring[][];
}
export interface Modes { kind: "modes"; id: number; modes: { size: number; parts: string[]; ends?: boolean }[] }
export interface RankReply {
  kind: "rank"; id: number; parts: Record<string, { mm_per_mm: number; tighter: number; percent: number }>;
  joints: { parts: [string, string]; mm_per_mm: number; percent: number }[]; per: string; unique: boolean; note: string; command: string;
}
export interface CheckReply {
  kind: "check"; id: number; verdict: string; certainty: string; words: string; sure: [string, string][];
  escapes: { parts: string[]; words: string }[]; spins: string[]; remains: string[]; border: string | null; command: string;
}
export interface Step { kind: "step"; id: number; gap: number; objective: number | null; verdict: string }
export interface SweepReply { kind: "sweep"; id: number; steps: { gap: number; objective: number | null; verdict: string }[]; lost: [number, number] | null }
export interface SpaceReply {
  kind: "space"; id: number; a: string; b: string; open?: boolean; words?: string;
  vertices: string; triangles: string; slices: { angle_deg: number; rings: Ring[] }[];
  headline: string; facts: string[]; command: string;
  range_deg: [number, number]; state: [number, number, number]; pivot: Point; scale: number;
}
export interface ProveReply { kind: "prove"; id: number; at_most: number | null; within: number | null; words: string }
export interface Saved { kind: "saved"; id: number; name: string; mime: string; data: string }
export interface ShapeReply { kind: "shape"; id: number; rings: Ring[][] }
export interface Progress {
  kind: "progress"; id: number; kind_of: string; stage: string; round?: number; iteration?: number;
  objective?: number | null; share: number | null;
}
export interface Failed { kind: "failed"; id: number; of: string; findings: string[] }
export interface WorkerSays { kind: "worker"; state: "ready" | "lost" | "restarted" }
export interface Hello { kind: "hello"; version: string; can: string[]; limits: { upload_mb: number } }

export type Reply =
  | Hello | Opened | ShapeReply | FlexReply | DragReply | Modes | RankReply | CheckReply | Step | SweepReply
  | SpaceReply | ProveReply | Saved | Progress | Failed | WorkerSays;

export type SaveWhat = "svg" | "png" | "gif" | "mp4" | "html" | "json" | "assembly" | "cut-svg" | "cut-dxf";

/** Kinds of requests, each with what it carries beside its id. */
export interface Requests {
  open: { name: string; data: string; unit?: string; flatten?: number };
  shape: { design: Design };
  flex: { design: Design; thorough: boolean };
  drag: { design: Design; part: string; grip: Point; target: Point; from: "rest" | "here" };
  release: { design: Design };
  wiggle: { design: Design; part?: string };
  rank: { design: Design };
  check: { design: Design };
  sweep: { design: Design; gaps?: number[] };
  space: { design: Design; a: string; b: string };
  prove: { design: Design; share: number; seconds: number };
  save: { design: Design; what: SaveWhat; of: "flex" | "check" };
}
export type Kind = keyof Requests;

/** What a cell of a table holds: a word, names of parts, or a number; null where it is not known. */
export type Cell = string | readonly string[] | number | null;
/** A piece of a page under its heading. */
export interface Piece { title: string; text: string; svg: string; columns: string[]; rows: Cell[][]; terms: [string, string][] }
export interface Study { tab: string; sections: Piece[] }

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
