/** Whether it comes apart, and the ways out as films. */

import { design } from "../design.ts";
import { shown } from "../motion.ts";
import { ask, showEscape } from "../session.ts";
import { standalone, checked, current } from "../state.ts";
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
                  icon="play" label={`Play the way out of ${few(one.parts)}`} pressed={shown.value.what === "escape" && shown.value.frames === about.ways[i]}
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
    {standalone.value && <Command text={about?.reply.command} />}
    </>
  );
}
