/** How sure the answer is, and proving a bound. */

import { useSignal } from "@preact/signals";
import { design } from "../design.ts";
import { ask, cancel } from "../session.ts";
import { answer, baked, can, current, hello, proof, running } from "../state.ts";
import { number } from "../words.ts";
import { Button } from "../chrome/Button.tsx";
import { NumberBox } from "../chrome/NumberBox.tsx";
import { Section } from "./Section.tsx";

export function Sure() {
  const about = answer.value;
  return (
    <>
      <Section title="How sure is it">
        {about ? (
          <dl class="sure">{about.reply.sure.map(([term, words]) => <div key={term}><dt>{term}</dt><dd>{words}</dd></div>)}</dl>
        ) : <p class="quiet">No answer yet.</p>}
      </Section>
      {!baked.value && about?.reply.objective != null && <Prove />}
    </>
  );
}

function Prove() {
  const percent = useSignal(1);
  const seconds = useSignal(20);
  const busy = running.value.has("prove");
  const missing = hello.value !== null && !can("prove");
  const start = (): void => void ask("prove", { design: design.peek(), share: percent.value / 100, seconds: seconds.value });
  return (
    <Section title="Prove a bound">
      <p>A value that no motion can exceed. It takes longer than the answer, and needs joints that close round each other.</p>
      <div class="asks">
        <label>within <NumberBox value={percent.value} min={0.01} step={0.5} unit="%" label="how near the bound should come" onChange={(v) => (percent.value = v)} /></label>
        <label>for at most <NumberBox value={seconds.value} min={1} step={5} unit="s" label="time for the proof" onChange={(v) => (seconds.value = v)} /></label>
        {busy ? <Button label="Cancel" onClick={() => cancel("prove")}>Cancel</Button>
          : <Button label="Prove a bound" onClick={start} disabled={missing} class="main">Prove</Button>}
      </div>
      {missing && <p class="quiet">Needs the extra <code>prove</code>: pip install 'wiggleroom[prove]'</p>}
      {proof.value && (
        <div class={current(proof.value) ? "result" : "result old"}>
          <p class="strong">{proof.value.reply.words}</p>
          {proof.value.reply.at_most != null && <p class="quiet">at most {number(proof.value.reply.at_most, 5)}{proof.value.reply.within != null ? `, within ${number(proof.value.reply.within * 100, 2)} %` : ""}</p>}
          {!current(proof.value) && <p class="quiet">said of an earlier design</p>}
        </div>
      )}
    </Section>
  );
}
