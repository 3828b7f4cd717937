/** A page that carries its answers: no server, the slider goes over the stored gaps. */

import { effect } from "@preact/signals";
import { begin, design } from "./design.ts";
import { autoFactor, fittingFactor, reach, showAnswer } from "./motion.ts";
import { type CheckReply, type FlexReply, type Frames, fromBase64, type Opened, type RankReply } from "./protocol.ts";
import * as state from "./state.ts";

interface Packed { k: number; n: number; data: string }
interface Baked {
  opened: Opened;
  answers: { gap: number; flex: FlexReply; frames: string }[];
  lost?: [number, number] | null;
  rank?: RankReply;
  check?: { reply: CheckReply; ways: Packed[] };
}

/** True where the page carries its answers; then they are shown. */
export function unpack(): boolean {
  const text = document.getElementById("baked")?.textContent;
  if (!text) return false;
  const told = JSON.parse(text) as Baked;
  const n = told.opened.parts.length;
  const answers = told.answers
    .map((one) => ({ gap: one.gap, flex: one.flex, frames: floats(one.frames, n) }))
    .sort((a, b) => a.gap - b.gap);
  const nearest = (gap: number) => answers.reduce((best, one) => (Math.abs(one.gap - gap) < Math.abs(best.gap - gap) ? one : best), answers[0]!);
  const first = nearest(told.opened.design.gap);
  state.baked.value = true;
  state.line.value = "open";
  state.drawing.value = told.opened;
  begin({ ...told.opened.design, gap: first.gap });
  const about = <T>(reply: T, ways: Frames[]) => ({ reply, design: design.peek(), ways });
  state.solved.value = answers.map(({ gap, flex, frames }) => ({ gap, objective: flex.objective, verdict: flex.verdict, end: frames.data.slice(-3 * n) }));
  state.lost.value = told.lost ?? null;
  if (told.rank) state.ranking.value = about(told.rank, []);
  if (told.check) state.checked.value = about(told.check.reply, told.check.ways.map((one) => ({ ...one, data: floats(one.data, one.n).data })));
  effect(() => {
    const { gap } = design.value;
    const { flex, frames } = nearest(gap);
    state.rings.value = flex.rings ?? told.opened.parts.map((part) => part.rings);
    state.answer.value = about(flex, [frames]);
    autoFactor.value = fittingFactor(reach(frames, state.radii.peek()), state.extent.peek().radius, autoFactor.peek());
    showAnswer(frames, flex.leaves.length > 0);
  });
  return true;
}

function floats(base64: string, n: number): Frames {
  const data = new Float32Array(fromBase64(base64).buffer);
  return { k: data.length / (3 * n), n, data };
}
