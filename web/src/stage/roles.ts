/** How each part is to be painted: its role, and what lights it up. Changes seldom, so it is worked out apart from the frames. */

import { computed } from "@preact/signals";
import { fixedNames, pinned, pulledNames } from "../design.ts";
import { leavingStep } from "../leaving.ts";
import { shown } from "../motion.ts";
import { own } from "../words.ts";
import { type About, answer, standalone, coloured, current, dragged, names, pointed, ranking, space as pair, studies, tab, tinted } from "../state.ts";

export type Role = "neutral" | "pulled" | "fixed" | "leaves" | "lit";

/** Shares 0..1 of the importance of the parts; null while the ranking is not shown. */
export const blame = computed<Float32Array | null>(() => {
  const shares = tab.value === "gaps" ? blamed() : tab.value === "vary" ? varied() : tab.value === "study" ? standalone.value?.tints?.values : undefined;
  if (!shares || !coloured.value) return null;
  const values = names.value.map((name) => Math.abs(own(shares, name) ?? 0));
  const most = Math.max(...values, 1e-12);
  return Float32Array.from(values, (v) => v / most);
});

/** Colours of the study that was made or chosen last, while it is about this design. */
function varied(): Record<string, number> | undefined {
  const about = studies.value[tinted.value];
  return about && told(about) ? about.reply.tints.values : undefined;
}

const told = (about: About<unknown>): boolean => standalone.value !== null || current(about);

function blamed(): Record<string, number> | undefined {
  const parts = ranking.value && told(ranking.value) ? ranking.value.reply.parts : undefined;
  return parts && Object.fromEntries(Object.entries(parts).map(([name, one]) => [name, one.mm_per_mm]));
}

export const roles = computed<Role[]>(() => {
  const leaving = new Set(
    shown.value.what === "escape" ? (leavingStep()?.parts ?? []) : (answer.value?.reply.leaves ?? []),
  );
  const pressed = new Set(pointed.value?.parts ?? []);
  const held = new Set(shown.value.what === "drag" ? (dragged.value?.reply.blocking ?? []) : []);
  const space = standalone.value ? pair.value?.reply : undefined; // the pair that the page is about
  const role = (name: string): Role => {
    if (pressed.has(name)) return "lit";
    if (space?.a === name || fixedNames.value.has(name) || pinned.value.has(name)) return "fixed";
    if (space?.b === name) return "pulled";
    if (held.has(name)) return "lit";
    if (shown.value.what === "drag" && dragged.value?.reply.part === name) return "pulled";
    if (leaving.has(name)) return "leaves";
    return pulledNames.value.has(name) ? "pulled" : "neutral";
  };
  return names.value.map(role);
});
