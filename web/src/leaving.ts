/** What leaves on the path that is shown: of a check, or of a plan. */

import { shown } from "./motion.ts";
import type { LeavingEntry } from "./protocol.ts";
import { checked, planned } from "./state.ts";

export function leavingOf(): "check" | "plan" | null {
  const { what, frames } = shown.value;
  if (what !== "escape" || !frames) return null;
  if (planned.value?.paths.includes(frames)) return "plan";
  return checked.value?.paths.includes(frames) ? "check" : null;
}

export function leavingStep(): LeavingEntry | null {
  const of = leavingOf();
  const about = of === "plan" ? planned.value : checked.value;
  if (!of || !about) return null;
  const all = about.reply.kind === "plan" ? about.reply.steps : about.reply.escapes;
  return all[about.paths.indexOf(shown.value.frames!)] ?? null;
}
