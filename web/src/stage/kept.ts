/** An answer that is kept beside the present one, to compare two designs or two gaps. */

import { signal } from "@preact/signals";
import { change, design } from "../design.ts";
import { type About, answer, drawing, indexOf, names, rings } from "../state.ts";
import type { FlexReply } from "../protocol.ts";
import type { Role } from "./roles.ts";
import { type Shape, shapes } from "./shapes.ts";

export interface Kept { about: About<FlexReply>; shapes: Shape[]; roles: Role[] }
export const kept = signal<Kept | null>(null);

/** True where there is a settled answer to the present design. */
export const canKeep = (): boolean => answer.value !== null && answer.value.design === design.value && answer.value.reply.settled && answer.value.paths.length > 0;

/** Keeps the present answer. */
export function keep(): void {
  const about = answer.peek();
  const opened = drawing.peek();
  if (about && opened && canKeep()) kept.value = { about, shapes: shapes(opened.parts, rings.peek()), roles: rolesOf(about) };
}

/** Goes back to the design that is kept, and keeps the present one in its place. */
export function swap(): void {
  const before = kept.peek();
  if (!before) return;
  keep();
  change(before.about.design);
}

function rolesOf({ design, reply }: About<FlexReply>): Role[] {
  const goals = typeof design.goals === "string" ? [] : design.goals;
  const all: Role[] = names.peek().map(() => "neutral");
  const mark = (some: readonly string[], role: Role): void => some.forEach((name) => (all[indexOf.peek().get(name)!] = role));
  mark(goals.map((goal) => goal.part), "pulled");
  mark(reply.leaves, "leaves");
  mark(design.fixed, "fixed");
  return all;
}

/** What differs between the kept design and the present one, in a line. */
export function difference(): string {
  const before = kept.value?.about;
  const now = answer.value;
  if (!before || !now || now.design !== design.value || !now.reply.settled) return "";
  const told: string[] = [];
  if (before.design.gap !== now.design.gap) told.push(`gap ${before.design.gap} → ${now.design.gap} mm`);
  for (const [what, differ] of [
    ["gaps of parts", before.design.extra], ["gaps of joints", before.design.gaps ?? []], ["fixed parts", before.design.fixed], ["glue", before.design.glue], ["pull", before.design.goals],
  ] as const) {
    const other = { "gaps of parts": now.design.extra, "gaps of joints": now.design.gaps ?? [], "fixed parts": now.design.fixed, glue: now.design.glue, pull: now.design.goals }[what];
    if (JSON.stringify(differ) !== JSON.stringify(other)) told.push(`other ${what}`);
  }
  const [a, b] = [before.reply.objective, now.reply.objective];
  const alike = JSON.stringify(before.design.goals) === JSON.stringify(now.design.goals);
  if (alike && a !== null && b !== null && a > 0) told.push(`motion × ${Number((b / a).toPrecision(3))}`);
  return told.join(" · ") || "the same design";
}
