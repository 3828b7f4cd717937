/** What the page knows: the drawing, the answers, and what is chosen. Signals only; `session.ts` fills them. */

import { computed, signal } from "@preact/signals";
import { design, inSpace } from "./design.ts";
import type {
  BoundReply, CheckReply, Design, DragReply, Fault, FlexReply, Frames, Hello, LimitReply, Modes, Opened, PlanReply, Point, ProgressReply, ProveReply, RankReply, ReachReply, Ring, Solids, SpaceReply, StudyReply, StudyTab,
} from "./protocol.ts";
import type { Opening } from "./keep.ts";
import type { Line } from "./socket.ts";
import type { Section } from "./stage3d.ts";
import { boxOf, reachOfSolids } from "./solids.ts";

/** An answer and the design that it answers. */
export interface About<T> { reply: T; design: Design; paths: Frames[] }

/** On a page that carries what was found: what it is about, and more than the panels of the live page say. */
export interface Told { said: { title: string; facts: string[] } | null; study: StudyTab | null; tints: { per: string; values: Record<string, number> } | null }
export const standalone = signal<Told | null>(null);
export const line = signal<Line>("connecting");
export const hello = signal<Hello | null>(null);
export const workerState = signal<"ready" | "lost" | "restarted">("ready");
export const findings = signal<Fault[]>([]);
/** Why a file could not be opened; what was open before stays, with what is wrong with it. */
export const unopened = signal<string[]>([]);
/** The finding that is shown in the picture. */
export const pointed = signal<Fault | null>(null);
/** What failed last: its findings go when it succeeds. */
export const trouble = signal("");
const noticed = signal<{ words: string; design: Design } | null>(null);
/** A line about the design as it is; it goes with the next change of it. */
export const notice = {
  get value(): string {
    return noticed.value?.design === design.value ? noticed.value.words : "";
  },
  set value(words: string) {
    noticed.value = words ? { words, design: design.peek() } : null;
  },
};
export const opening = signal("");
/** Whether the start page lies over what is open. */
export const atStart = signal(false);

export const drawing = signal<Opened | null>(null);
/** The file that was opened here; null where it is that of the command. */
export const file = signal<Opening | null>(null);
/** Name of the file that the command was given. */
export const served = signal("");
export const rings = signal<Ring[][]>([]);
/** The design whose outlines are shown; null while they are as drawn. */
export const shaped = signal<Design | null>(null);
/** Whether they are those of the present design. */
export const shapedNow = computed(() => shaped.value !== null && (shaped.value === design.value || shapeOf(shaped.value) === shapeOf(design.value)));
const shapeOf = ({ gap, extra, gaps, glue }: Design): string => JSON.stringify([gap, extra, gaps, glue]);
/** Parts in space as they are made. */
export const solids = signal<Solids | null>(null);
export const names = computed(() => drawing.value?.parts.map((part) => part.name) ?? []);
export const indexOf = computed(() => new Map(names.value.map((name, i) => [name, i])));

export const answer = signal<About<FlexReply> | null>(null);
export const dragged = signal<About<DragReply> | null>(null);
/** The part that is under the hand, or was last, and where it was taken, at rest. */
export const dragging = signal<{ part: string; grip: readonly number[] } | null>(null);
export const modes = signal<About<Modes> | null>(null);
export const ranking = signal<About<RankReply> | null>(null);
export const checked = signal<About<CheckReply> | null>(null);
export const limit = signal<About<LimitReply> | null>(null);
export const planned = signal<About<PlanReply> | null>(null);
export const reach = signal<About<ReachReply> | null>(null);
/** Where the chosen part was pressed, at rest. */
export const pressed = signal<Point | null>(null);
export const space = signal<About<SpaceReply> | null>(null);
/** What studies found, by the name of the question. */
export const studies = signal<Readonly<Record<string, About<StudyReply>>>>({});
/** The study whose colours the parts have. */
export const tinted = signal("");
export const proof = signal<About<ProveReply> | null>(null);
/** A quick bound of the answer, worked out after it. */
export const bound = signal<About<BoundReply> | null>(null);

/** Answers at several gaps to the present question, by gap. */
export interface Solved { gap: number; objective: number | null; verdict: string; end: Float32Array | null; atMost?: number | null }
export const solved = signal<Solved[]>([]);
export const lost = signal<[number, number] | null>(null);

/** Requests under way, by kind, with the last progress that was told. */
export const running = signal<ReadonlyMap<string, ProgressReply | null>>(new Map());
export const waiting = signal(false);
/** What is worked on for the hand: the drawing, the answer, the drag. */
export const busy = computed(() => ["open", "flex", "drag", "shape"].some((kind) => running.value.has(kind)));
/** True where an answer to the present question is on its way: what is shown is none yet. */
export const unsure = computed(() => running.value.has("flex") && !(answer.value?.design === design.value && answer.value.reply.settled));

export const selected = signal<string | null>(null);
/** Parts that are chosen together; empty where it is one or none. */
export const many = signal<ReadonlySet<string>>(new Set());
export const hovered = signal<string | null>(null);
export const gluing = signal<string | null>(null);
export const highlit = signal<readonly number[] | null>(null);
/** Parts in space that are only outlined, so that one sees past them. */
export const outlined = signal<ReadonlySet<string>>(new Set());
/** How far parts in space are taken apart in the picture, 0 to 1.5. */
export const exploded = signal(0);
/** Where parts in space are cut through in the picture. */
export const section = signal<Section | null>(null);

export type Tab = "answer" | "gaps" | "vary" | "apart" | "space" | "sheet" | "study" | "sure";
export const tab = signal<Tab>("answer");
export const sheetOpen = signal(false);
export const helpOpen = signal(false);
export const coloured = signal(true);

const paper = typeof matchMedia === "function" ? matchMedia("print") : null;
/** True while the page goes to paper: all panels are there, in light colours. */
export const printing = signal(paper?.matches ?? false);
paper?.addEventListener("change", (event) => (printing.value = event.matches));
if (paper) for (const [event, on] of [["beforeprint", true], ["afterprint", false]] as const) addEventListener(event, () => (printing.value = on));

export const current = (about: About<unknown> | null): boolean => about !== null && about.design === design.value;
export const can = (what: string): boolean => hello.value?.can.includes(what) ?? false;

/** How far each part's outline reaches from its reference point [mm]. */
export const radii = computed(() => (inSpace() && solids.value ? reachOfSolids(solids.value) :
  (drawing.value?.parts ?? []).map(({ at, rings }) => rings.flat().reduce((most, [x, y]) => Math.max(most, Math.hypot(x - at[0], y - at[1])), 0)))
);

/** Width and height of what was drawn, and half its diagonal [mm]; of parts in space that of the box round them. */
export const extent = computed(() => {
  if (inSpace() && solids.value) {
    const { low, high } = boxOf(solids.value);
    return { x0: low[0], y0: low[1], x1: high[0], y1: high[1], radius: Math.hypot(...high.map((v, k) => v - low[k]!)) / 2 || 1 };
  }
  const [x0, y0, x1, y1] = drawing.value?.size ?? [0, 0, 1, 1];
  return { x0, y0, x1, y1, radius: Math.hypot(x1 - x0, y1 - y0) / 2 || 1 };
});
