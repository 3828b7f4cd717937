/** A cutting sheet that is put together: hints are given by clicks, and the server is asked anew. */

import { computed, effect, untracked } from "@preact/signals";
import type { Point, SheetHints, SheetPanel } from "./protocol.ts";
import { toBase64 } from "./protocol.ts";
import { download } from "./save.ts";
import { ask, openAs } from "./session.ts";
import { assembled, burn, hints, laid, past, picked, poses, thickness, tool, type Picked, type Tool } from "./sheetState.ts";
import { drawing, notice } from "./state.ts";

export * from "./sheetState.ts";

const request = () => ({ thickness: thickness.peek(), ...(burn.peek() !== null && { burn: burn.peek() }), hints: hints.peek() });

export const assemble = (): void => void ask("assemble", request());

/** Takes hints in place of those before, and puts the sheet together anew. */
function say(next: SheetHints): void {
  past.value = [...past.peek(), hints.peek()].slice(-50);
  hints.value = next;
  picked.value = [];
  assemble();
}

export function undoHint(): void {
  const before = past.peek().at(-1);
  if (!before) return;
  past.value = past.peek().slice(0, -1);
  hints.value = before;
  poses.value = null;
  assemble();
}

/** Leaves out one of the hints of a kind. */
export function drop(kind: keyof SheetHints, index: number): void {
  poses.value = null;
  say({ ...hints.peek(), [kind]: hints.peek()[kind].filter((_, k) => k !== index) });
}

export function setTool(next: Tool): void {
  tool.value = next;
  picked.value = [];
}

/** Two edges by their names belong together, or end in one plane. */
export function pair(kind: "join" | "flush", a: string, b: string): void {
  say({ ...hints.peek(), [kind]: [...hints.peek()[kind], [a, b]] });
}

/** An edge, or a panel, was pressed. */
export function press(one: Picked): void {
  const before = picked.peek();
  if (tool.peek() === "skip") return say({ ...hints.peek(), skip: [...hints.peek().skip, one.panel] });
  if (before.some((other) => other.panel === one.panel)) {
    picked.value = before.filter((other) => other.panel !== one.panel);
    return;
  }
  const both = [...before, one];
  picked.value = both;
  if (tool.peek() === "body" || both.length < 2) return;
  const [a, b] = both as [Picked, Picked];
  if (tool.peek() === "lay") layOn(a, b);
  else pair(tool.peek() as "join" | "flush", a.edge, b.edge);
}

/** The panels that are chosen make one body. */
export function together(): void {
  const names = picked.peek().map((one) => one.panel);
  if (names.length > 1) say({ ...hints.peek(), groups: [...hints.peek().groups, names] });
}

/** Lays a panel on another one: asks where it could lie. */
export function layOn(a: Picked, b: Picked): void {
  picked.value = [];
  const others = hints.peek().plate.filter((plate) => plate.panel !== a.panel);
  ask("lay", { ...request(), hints: { ...hints.peek(), plate: others }, panel: a.panel, at: a.at, onto: b.panel, there: b.at });
}

effect(() => {
  const reply = laid.value;
  if (!reply) return;
  poses.value = { plates: reply.poses, taken: 0 };
  untracked(() => take(0));
});

/** Takes one of the poses the panel that was laid last. */
export function take(which: number): void {
  const known = poses.peek();
  if (!known) return;
  const plate = known.plates[((which % known.plates.length) + known.plates.length) % known.plates.length]!;
  poses.value = { plates: known.plates, taken: known.plates.indexOf(plate) };
  say({ ...hints.peek(), plate: [...hints.peek().plate.filter((other) => other.panel !== plate.panel), plate] });
}

const text = (words: string): string => toBase64(new TextEncoder().encode(words));
const stem = (): string => drawing.peek()!.name.replace(/\.[^.]*$/, "");

export function saveHints(): void {
  const found = assembled.peek();
  if (found) download({ kind: "saved", id: 0, name: `${stem()}.toml`, mime: "application/toml", data: text(found.toml) });
}

export function saveAssembly(): void {
  const found = assembled.peek();
  if (found) download({ kind: "saved", id: 0, name: `${stem()}-assembled.json`, mime: "application/json", data: text(found.file) });
}

/** Opens what was put together, to ask how it moves and whether it comes apart. */
export function goOn(): void {
  const found = assembled.peek();
  if (!found?.file) return;
  notice.value = "";
  openAs({ name: `${stem()}-assembled.json`, data: text(found.file) });
}

/** The middle of a side of a panel as it lies on the sheet. */
export function sidePoint(panel: SheetPanel, side: string): Point {
  const [xs, ys] = [0, 1].map((k) => panel.rings[0]!.map((point) => point[k]!));
  const [x0, x1, y0, y1] = [Math.min(...xs!), Math.max(...xs!), Math.min(...ys!), Math.max(...ys!)];
  const middle: Point = [(x0 + x1) / 2, (y0 + y1) / 2];
  return ({ left: [x0, middle[1]], right: [x1, middle[1]], bottom: [middle[0], y0], top: [middle[0], y1] } as Record<string, Point>)[side] ?? middle;
}

/** Hues that stay apart however many there are, the same on the sheet and in space. */
export const hueOf = (index: number): number => Math.round((36 + 222.49 * index) % 360);

/** What was said, in words, with how to take it back. */
export const said = computed(() => {
  const now = hints.value;
  return [
    ...now.join.map((pair, k) => ({ kind: "join" as const, k, words: `${pair[0]} holds ${pair[1]}` })),
    ...now.flush.map((pair, k) => ({ kind: "flush" as const, k, words: `${pair[0]} and ${pair[1]} end in one plane` })),
    ...now.groups.map((names, k) => ({ kind: "groups" as const, k, words: `one body: ${names.join(", ")}` })),
    ...now.plate.map(({ panel, frame }, k) => ({ kind: "plate" as const, k, words: `${panel} is laid on ${frame}` })),
    ...now.skip.map((name, k) => ({ kind: "skip" as const, k, words: `${name} is no part of it` })),
  ];
});
