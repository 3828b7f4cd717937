/** A page that carries what was found: no server, the slider goes over the stored gaps. */

import { effect } from "@preact/signals";
import { begin, design } from "./design.ts";
import { followed, magnify, reachOf } from "./magnify.ts";
import { calm, end, showAnswer, showRest } from "./motion.ts";
import { type StandalonePage, type Frames, fromBase64, type PackedFrames, type Ring, type SharedOutlines } from "./protocol.ts";
import { showEscape } from "./session.ts";
import { outOf, posed } from "./stage/shapes.ts";
import { nearestBy } from "./words.ts";
import * as state from "./state.ts";

/** True where the page carries what was found; then it is shown. */
export function unpack(): boolean {
  const text = document.getElementById("standalone")?.textContent;
  if (!text) return false;
  const { opened, answers = [], said = null, study = null, tints = null, ...told } = JSON.parse(text) as StandalonePage;
  const standing = ({ shapes, of }: SharedOutlines): Ring[][] => opened.parts.map(({ at: [x, y, degrees] }, i) => {
    const pose = posed(x, y, (degrees * Math.PI) / 180);
    return shapes[of[i]!]!.map((ring) => ring.map((point) => outOf(pose, point)));
  });
  const rest = standing(opened.outlines);
  state.standalone.value = { said, study, tints };
  state.line.value = "open";
  state.drawing.value = { ...opened, dimension: 2, ignore: [], apart: false, parts: opened.parts.map((part, i) => ({ ...part, rings: rest[i]! })) };
  state.tab.value = told.tab ?? "answer";
  state.sheetOpen.value = told.tab === "space" || told.tab === "study"; // on a phone: what the page is about
  state.lost.value = told.lost ?? null;
  begin({ ...opened.design, gap: told.begin ?? opened.gap });
  const about = <T>(reply: T, paths: Frames[]) => ({ reply, design: design.peek(), paths });
  if (told.rank) state.ranking.value = about(told.rank, []);
  if (told.check) state.checked.value = about(told.check.reply, told.check.paths.map(frames));
  if (told.space) state.space.value = about(told.space, []);
  const known = answers.map(({ gap, flex, path, outlines }) => ({ gap, flex, path: frames(path), outlines }));
  const steps = told.steps ?? known.map(({ gap, flex: { objective, verdict, at_most } }) => ({ gap, objective, verdict, at_most }));
  state.solved.value = steps.map(({ gap, objective, verdict, at_most }) => {
    const one = known.find((other) => other.gap === gap);
    return { gap, objective, verdict, end: one && objective !== null ? end(one.path) : null, atMost: at_most ?? null };
  });
  state.rings.value = rest;
  state.shaped.value = design.peek();
  if (known.length === 0) {
    showRest(false);
    if (!calm()) showEscape(0);
  }
  else effect(() => {
    const { gap } = design.value;
    const { flex, path, outlines, ...one } = nearestBy(known, (other) => other.gap, gap)!;
    if (Math.abs(one.gap - gap) > 1e-5 * gap) { // a gap of the curve without an answer
      state.answer.value = null;
      return showRest();
    }
    state.rings.value = outlines ? standing(outlines) : rest;
    state.shaped.value = design.value;
    state.answer.value = about(flex, [path]);
    magnify(reachOf(path));
    showAnswer(path, flex.leaves.length > 0, followed());
  });
  return true;
}

function frames({ k, n, data }: PackedFrames): Frames {
  return { k, n, data: new Float32Array(fromBase64(data).buffer) };
}
