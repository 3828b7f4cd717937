/** Whether it comes apart, and the paths out as films. */

import { useSignal } from "@preact/signals";
import { change, design, fixedNames, inSpace } from "../design.ts";
import { shown } from "../motion.ts";
import { ask, showEscape } from "../session.ts";
import { standalone, checked, current, limit, many, opening, planned, running, selected } from "../state.ts";
import { few } from "../words.ts";
import { Button } from "../chrome/Button.tsx";
import { Run } from "../chrome/Run.tsx";
import { Command } from "./Command.tsx";
import { Section } from "./Section.tsx";

export function Apart() {
  const about = checked.value;
  return (
    <>
    <Section title="Does it come apart?">
      <p>Can some parts be moved without limit away from the others? Turning in place is not coming apart.</p>
      {!standalone.value && (
        <div class="asks"><Run kind="check" label="Check" onClick={() => void ask("check", { design: design.peek() })}>Check</Run></div>
      )}
      {about && (
        <div class={current(about) || standalone.value ? "result" : "result old"}>
          <p class="verdict" data-verdict={about.reply.verdict}>{about.reply.verdict}</p>
          <p class="why">{about.reply.words.replace(/^[^:]*: /, "")}</p>
          {!current(about) && !standalone.value && <p class="quiet">said of an earlier design</p>}
          <ul class="rows">
            {about.reply.escapes.map((one, i) => (
              <li class="row" key={i}>
                <Button
                  icon="play" label={`Play the path out of ${few(one.parts)}`} pressed={shown.value.what === "escape" && shown.value.frames === about.paths[i]}
                  onClick={() => showEscape(i)}
                />
                <span class="grow">{one.words}</span>
              </li>
            ))}
          </ul>
          {about.reply.escapes.length > 0 && about.reply.remains.length > 1 && <p>Remains interlocked: {few(about.reply.remains)}</p>}
          {about.reply.spins.length > 0 && <p>Can spin in place: {few(about.reply.spins)}</p>}
          {about.reply.border && <p class="border">{about.reply.border}</p>}
        </div>
      )}
    </Section>
    {!standalone.value && <LargestGap />}
    {!standalone.value && <Planned />}
    {standalone.value && <Command text={about?.reply.command} />}
    </>
  );
}

function LargestGap() {
  const about = limit.value;
  return (
    <Section title="The largest gap that holds">
      <p>Up to which gap the parts stay together, whatever moves.</p>
      <div class="asks"><Run kind="limit" label="Find the largest gap that holds it together" onClick={() => void ask("limit", { design: design.peek() })}>Find it</Run></div>
      {about && (
        <div class={current(about) ? "result" : "result old"}>
          <p class="strong">{about.reply.words}</p>
          {about.reply.holds !== null && about.reply.parts_at !== null && <p><Button label="Use the largest gap that holds" onClick={() => change({ gap: about.reply.holds! })} class="small">Use it</Button></p>}
          {!current(about) && <p class="quiet">said of an earlier design</p>}
          <Command text={about.reply.command} />
        </div>
      )}
    </Section>
  );
}

const IN_THE_PLANE: Record<string, number[] | null> = { "nowhere": null, "in -y": [0, -1], "in +y": [0, 1], "in -x": [-1, 0], "in +x": [1, 0] };
const IN_SPACE: Record<string, number[] | null> = { "nowhere": null, "in -z": [0, 0, -1], "in +z": [0, 0, 1], "in -y": [0, -1, 0], "in +y": [0, 1, 0], "in -x": [-1, 0, 0], "in +x": [1, 0, 0] };

/** In which order and along which paths parts are taken out: every step can be played. */
function Planned() {
  const falls = useSignal("nowhere");
  const about = planned.value;
  const directions = inSpace() ? IN_SPACE : IN_THE_PLANE;
  const chosen = many.value.size ? [...many.value] : selected.value ? [selected.value] : [];
  const loose = chosen.filter((name) => !fixedNames.value.has(name));
  const run = (targets: string[]): void => void ask("plan", { design: design.peek(), targets, gravity: directions[falls.value] ?? null });
  return (
    <Section title="Take apart, put together">
      <p>The order in which parts are taken out, and every step of it: who moves, how, and with how much room. Backwards it is how to put it together.</p>
      <div class="asks">
        <label>loose parts fall <select value={falls.value} aria-label="direction in which loose parts fall" onChange={(event) => (falls.value = event.currentTarget.value)}>
          {Object.keys(directions).map((name) => <option key={name} value={name}>{name}</option>)}
        </select></label>
        <Run kind="plan" label="Plan how to take it apart" onClick={() => run([])}>Plan</Run>
        {loose.length > 0 && !running.value.has("plan") && <Button label={`Plan how to take out ${few(loose)}`} onClick={() => run(loose)} disabled={opening.value !== ""}>{`Only ${few(loose, 2)}`}</Button>}
      </div>
      {about && (
        <div class={current(about) ? "result" : "result old"}>
          <p class="verdict" data-verdict={about.reply.verdict}>{about.reply.words}</p>
          {!current(about) && <p class="quiet">said of an earlier design</p>}
          <ol class="rows">
            {about.reply.steps.map((one, i) => (
              <li class="row" key={i}>
                <Button
                  icon="play" label={`Play step ${i + 1}: ${one.words}`} pressed={shown.value.what === "escape" && shown.value.frames === about.paths[i]}
                  onClick={() => showEscape(i, about)}
                />
                <span class="grow">{i + 1}. {one.words}</span>
              </li>
            ))}
          </ol>
          {about.reply.facts.map((fact) => <p class="quiet" key={fact}>{fact}</p>)}
          <Command text={about.reply.command} />
        </div>
      )}
    </Section>
  );
}
