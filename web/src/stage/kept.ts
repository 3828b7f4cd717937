/** An answer that is kept beside the present one, to compare two designs, two gaps or two files. */

import { computed, signal } from "@preact/signals";
import { design, list } from "../design.ts";
import type { Design, FlexReply, Opened, Solids } from "../protocol.ts";
import { fitsParts, type Opening } from "../keep.ts";
import { type About, answer, drawing, file, indexOf, names, rings, solids } from "../state.ts";
import { ask, few, number } from "../words.ts";
import type { Role } from "./roles.ts";
import { type Shape, shapes } from "./shapes.ts";

export interface Kept { about: About<FlexReply>; opened: Opened; file: Opening | null; shapes: Shape[]; solids: Solids | null; roles: Role[] }
export const kept = signal<Kept | null>(null);
/** Whether both pictures are moved together; each has a view of its own else. */
export const linked = signal(true);

/** Whether what is kept is of the file that is open. */
export const ofThisFile = computed(() => kept.value?.opened.name === drawing.value?.name);

/** True where there is a settled answer to the present design. */
export const canKeep = (): boolean => answer.value !== null && answer.value.design === design.value && answer.value.reply.settled && answer.value.paths.length > 0;

/** The present answer as it may be kept; null where there is none. */
export function presentAnswer(): Kept | null {
  const [about, opened] = [answer.peek(), drawing.peek()];
  if (!about || !opened || !canKeep()) return null;
  return { about, opened, file: file.peek(), shapes: shapes(opened.parts, rings.peek()), solids: solids.peek(), roles: rolesOf(about) };
}

function rolesOf({ design, reply }: About<FlexReply>): Role[] {
  const all: Role[] = names.peek().map(() => "neutral");
  const mark = (some: readonly string[], role: Role): void => some.forEach((name) => (all[indexOf.peek().get(name)!] = role));
  mark(list(design.goals).map((goal) => goal.part), "pulled");
  mark(reply.leaves, "leaves");
  mark(design.fixed, "fixed");
  return all;
}

/** Whether what was asked of the kept file can be asked of the one that is open: all parts that it names are there. */
export const sameQuestionFits = (): boolean => fitsParts(kept.value!.about.design, drawing.value!);

const NAMED = 3;
const none = (words: string): string => words || "none";

/** What a design says, in words by its kinds. */
function settings({ gap, extra, gaps, fixed, glue, goals }: Design): Record<string, string> {
  return {
    gap: `${number(gap)} mm`,
    "gaps of parts": none(few(Object.entries(extra).map(([name, value]) => `${name} ${number(value)}`), NAMED)),
    "gaps of joints": none(few((gaps ?? []).map(([a, b, value]) => `${a} | ${b} ${number(value)}`), NAMED)),
    fixed: none(few(fixed, NAMED)),
    glued: none(few(glue.map((group) => group.join(" + ")), NAMED)),
    pulled: typeof goals === "string" ? goals : none(few(goals.map(ask), NAMED)),
  };
}

/** What differs between the kept answer and the present one: what it is, there, here. */
export function differences(): [string, string, string][] {
  const [one, now, opened] = [kept.value, answer.value, drawing.value];
  if (!one || !opened || !now || now.design !== design.value || !now.reply.settled) return [];
  const before = one.about;
  const [there, here] = [settings(before.design), settings(now.design)];
  const rows: [string, string, string][] = Object.keys(there).map((key) => [key, there[key]!, here[key]!]);
  const [a, b] = [before.reply.objective, now.reply.objective];
  const alike = there["pulled"] === here["pulled"] && a !== null && b !== null && a > 0;
  const said = (reply: FlexReply): string => (reply.objective === null ? "without end" : number(reply.objective));
  return [
    ["motion", said(before.reply), said(now.reply) + (alike && a !== b ? ` (× ${number(b / a, 3)})` : "")], ["verdict", before.reply.verdict, now.reply.verdict],
    ["file", one.opened.name, opened.name], ["parts", String(one.opened.parts.length), String(opened.parts.length)], ...rows,
  ].filter(([, was, is]) => was !== is) as [string, string, string][];
}
