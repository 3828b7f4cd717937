/** How each part is to be painted: its role, and what lights it up. Changes seldom, so it is worked out apart from the frames. */

import { computed } from "@preact/signals";
import { fixedNames, pulledNames } from "../design.ts";
import { shown } from "../motion.ts";
import { answer, checked, coloured, drawing, dragged, ranking, tab } from "../state.ts";

export type Role = "neutral" | "pulled" | "fixed" | "leaves" | "lit";

/** Shares 0..1 of the importance of the parts; null while the ranking is not shown. */
export const blame = computed<Float32Array | null>(() => {
  const about = ranking.value;
  if (!about || tab.value !== "gaps" || !coloured.value) return null;
  const values = drawing.value?.parts.map((part) => Math.abs(about.reply.parts[part.name]?.mm_per_mm ?? 0)) ?? [];
  const most = Math.max(...values, 1e-12);
  return Float32Array.from(values, (v) => v / most);
});

/** Parts that leave in the step that is shown. */
function escaping(): string[] {
  const about = checked.value;
  return about?.reply.escapes[about.ways.indexOf(shown.value.frames!)]?.parts ?? [];
}

export const roles = computed<Role[]>(() => {
  const names = drawing.value?.parts.map((part) => part.name) ?? [];
  const leaving = new Set(
    shown.value.what === "escape" ? escaping() : (answer.value?.reply.leaves ?? []),
  );
  const held = new Set(shown.value.what === "drag" ? (dragged.value?.reply.blocking ?? []) : []);
  const role = (name: string): Role => {
    if (fixedNames.value.has(name)) return "fixed";
    if (held.has(name)) return "lit";
    if (shown.value.what === "drag" && dragged.value?.reply.part === name) return "pulled";
    if (leaving.has(name)) return "leaves";
    return pulledNames.value.has(name) ? "pulled" : "neutral";
  };
  return names.map(role);
});
