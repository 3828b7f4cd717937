/** Which parts to make tighter, and how far it moves where gaps vary at random. */

import { useSignal } from "@preact/signals";
import { asks, change, design, fixedNames } from "../design.ts";
import { ask } from "../session.ts";
import { answer, coloured, current, names, studies, tinted } from "../state.ts";
import { Button } from "../chrome/Button.tsx";
import { NumberBox } from "../chrome/NumberBox.tsx";
import { Run } from "../chrome/Run.tsx";
import { stepOf } from "../chrome/Selection.tsx";
import { Blamebar } from "./Ranked.tsx";
import { Command } from "./Command.tsx";
import { Section } from "./Section.tsx";
import { Sections } from "./Study.tsx";

export function Vary() {
  return <><Tighten /><Sample /></>;
}

const asked = (): boolean => asks(design.value) && answer.value?.reply.objective != null;

function Tighten() {
  const free = names.value.filter((name) => !fixedNames.value.has(name)).length;
  const parts = useSignal(Math.max(1, Math.min(3, free)));
  return (
    <Section title="Which parts should be tighter?">
      <p>The parts whose gap, made smaller, takes most of the motion away.</p>
      <div class="asks">
        <label>how many <NumberBox value={parts.value} min={1} step={1} label="how many parts to make tighter" onChange={(v) => (parts.value = Math.round(v))} /></label>
        <Run kind="tighten" label="Find the parts to make tighter" onClick={() => void ask("tighten", { design: design.peek(), parts: parts.value })} disabled={!asked()}>Find them</Run>
      </div>
      <Result of="tighten" />
    </Section>
  );
}

function Sample() {
  const { gap } = design.value;
  const spread = useSignal(0);
  const limit = useSignal(0);
  const draws = useSignal(100);
  const used = spread.value || Number((gap / 20).toPrecision(2));
  const run = (): void => void ask("sample", { design: design.peek(), spread: used, draws: draws.value, ...(limit.value > 0 && { limit: limit.value }) });
  return (
    <Section title="When gaps vary">
      <p>No cut is exact. Every try gives each part an extra gap of its own by chance, and says how far it then moves: the worst case, and how many stay below a limit.</p>
      <div class="asks">
        <label>standard deviation <NumberBox value={used} min={0} step={stepOf(gap / 5)} unit="mm" label="standard deviation of the gap" onChange={(v) => (spread.value = v)} /></label>
        <label>tries <NumberBox value={draws.value} min={1} step={50} label="number of tries" onChange={(v) => (draws.value = Math.min(Math.round(v), 5000))} /></label>
        <label>good up to <NumberBox value={limit.value} min={0} step={stepOf(10 * gap)} unit="mm" none="any" label="largest motion that is good" onChange={(v) => (limit.value = v)} /></label>
        <Run kind="sample" label="Try gaps at random" onClick={run} disabled={!asked() || used <= 0}>Try random gaps</Run>
      </div>
      <Result of="sample" />
    </Section>
  );
}

function Result({ of }: { of: "tighten" | "sample" }) {
  const about = studies.value[of];
  if (!about) return null;
  const { said, study, tints, command } = about.reply;
  const mine = coloured.value && tinted.value === of;
  return (
    <div class={current(about) ? "result" : "result old"}>
      <p class="strong">{of === "tighten" ? `Then ${said.title}` : said.title}</p>
      <p class="quiet">{said.facts.join(" · ")}</p>
      {!current(about) && <p class="quiet">said of an earlier design</p>}
      {current(about) && Object.keys(about.reply.extra).length > 0 && (
        <p class="likely"><Button label="Set these parts' extra gaps so; undo takes it back" onClick={() => change({ extra: { ...design.value.extra, ...about.reply.extra } })} class="small main">Make them tighter</Button></p>
      )}
      <label class="check"><input type="checkbox" checked={mine} onChange={(event) => { tinted.value = of; coloured.value = event.currentTarget.checked; }} /> colour the parts</label>
      {mine && tints.per && <Blamebar most={Math.max(...Object.values(tints.values))} per={tints.per} />}
      <Sections of={study} />
      <Command text={command} />
    </div>
  );
}
