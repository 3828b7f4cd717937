/** How sure the answer is, and proving a bound. */

import { useSignal } from "@preact/signals";
import { design } from "../design.ts";
import { ask } from "../session.ts";
import { answer, bound, standalone, can, checked, current, hello, planned, proof } from "../state.ts";
import { NumberBox } from "../chrome/NumberBox.tsx";
import { Run } from "../chrome/Run.tsx";
import { AsOf } from "./AsOf.tsx";
import { Section } from "./Section.tsx";
import { Terms } from "./Terms.tsx";

export function Sure() {
  const about = answer.value;
  return (
    <>
      {(about || !standalone.value) && <Section title="How sure is it">
        {about ? <><AsOf about={about} /><Terms all={about.reply.sure.map(withBound)} /></> : <p class="quiet">No answer yet.</p>}
      </Section>}
      {planned.value && current(planned.value) && <Section title="How sure is the plan"><Terms all={planned.value.reply.sure} /></Section>}
      {checked.value && (standalone.value || current(checked.value)) && <Section title="How sure is it whether it comes apart"><Terms all={checked.value.reply.sure} /></Section>}
      {!standalone.value && about?.reply.objective != null && <Prove />}
    </>
  );
}

/** What was worked out beside the answer, afterwards, where the answer itself has no bound. */
function withBound([term, words]: [string, string]): [string, string] {
  const beside = bound.value && current(bound.value) && current(answer.value) && answer.value?.reply.at_most === null ? bound.value.reply.words : "";
  return term === "at most" && beside ? [term, `${beside.replace(/^at most /, "")}, a quick bound`] : [term, words];
}

function Prove() {
  const percent = useSignal(1);
  const seconds = useSignal(20);
  const missing = hello.value !== null && !can("prove");
  const start = (): void => void ask("prove", { design: design.peek(), share: percent.value / 100, seconds: seconds.value });
  return (
    <Section title="Prove a bound">
      <p>A value that no motion can exceed. It takes longer than the answer, and needs joints that close round each other; in space, one part that moves.</p>
      <div class="asks">
        <label>within <NumberBox value={percent.value} min={0.01} step={0.5} unit="%" label="how near the bound should come" onChange={(v) => (percent.value = v)} /></label>
        <label>for at most <NumberBox value={seconds.value} min={1} step={5} unit="s" label="time for the proof" onChange={(v) => (seconds.value = v)} /></label>
        <Run kind="prove" label="Prove a bound" onClick={start} disabled={missing}>Prove</Run>
      </div>
      {missing && <p class="quiet">Needs the extra <code>prove</code>: pip install '.[prove]'</p>}
      {proof.value && (
        <div class={current(proof.value) ? "result" : "result old"}>
          <p class="strong">{proof.value.reply.words}</p>
          {!current(proof.value) && <p class="quiet">said of an earlier design</p>}
        </div>
      )}
    </Section>
  );
}
