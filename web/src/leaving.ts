/** What leaves on the path that is shown: of a check, or of a plan. */

import { shown } from "./motion.ts";
import type { CheckReply, LeavingEntry, PlanReply } from "./protocol.ts";
import { type About, checked, planned } from "./state.ts";

/** The check or the plan whose film is shown. */
export function leavingAbout(): About<CheckReply | PlanReply> | null {
  const { what, frames } = shown.value;
  if (what !== "escape" || !frames) return null;
  return [planned.value, checked.value].find((about) => about?.paths.includes(frames)) ?? null;
}

export function leavingStep(): LeavingEntry | null {
  const about = leavingAbout();
  if (!about) return null;
  const all = about.reply.kind === "plan" ? about.reply.steps : about.reply.escapes;
  return all[about.paths.indexOf(shown.value.frames!)] ?? null;
}
