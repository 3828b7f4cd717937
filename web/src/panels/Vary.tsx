/** Questions that the server declares, each with its options and what it found. */

import { useSignal } from "@preact/signals";
import { asks, change, design, fixedNames, inSpace } from "../design.ts";
import type { StudyField, StudyForm } from "../protocol.ts";
import { askStudy } from "../session.ts";
import { answer, coloured, current, hello, names, studies, tinted } from "../state.ts";
import { Button } from "../chrome/Button.tsx";
import { NumberBox } from "../chrome/NumberBox.tsx";
import { Run } from "../chrome/Run.tsx";
import { stepOf } from "../chrome/Selection.tsx";
import { Blamebar } from "./Ranked.tsx";
import { Command } from "./Command.tsx";
import { Section } from "./Section.tsx";
import { Sections } from "./Study.tsx";

type Values = Record<string, number | boolean>;

export function Vary() {
  const forms = (hello.value?.studies ?? []).filter(({ spatial }) => spatial || !inSpace());
  return <>{forms.map((form) => <Asked key={form.of} form={form} />)}</>;
}

/** What an option is before it is set; 0 or false where it is left out. */
function suggested({ kind, default: value, of_gap, of_parts }: StudyField): number | boolean {
  if (of_gap !== null) return Number((of_gap * design.value.gap).toPrecision(2));
  if (kind === "flag") return value === true;
  const free = names.value.filter((part) => !fixedNames.value.has(part)).length;
  return of_parts ? Math.max(1, Math.min(Number(value ?? 0), free)) : Number(value ?? 0);
}

function Asked({ form }: { form: StudyForm }) {
  const set = useSignal<Values>({});
  const value = (field: StudyField): number | boolean => set.value[field.name] ?? suggested(field);
  const take = (field: StudyField, to: number | boolean): void => {
    set.value = { ...set.value, [field.name]: field.kind === "count" ? Math.round(Number(to)) : to };
  };
  const run = (): void => {
    const other = form.fields.findIndex((field) => field.title.startsWith("or ") && set.value[field.name]); // in place of what stands before it
    const said = form.fields.filter((field, k) => (k < other ? set.value[field.name] : value(field) || field.default !== null));
    askStudy(form.of, Object.fromEntries(said.map((field) => [field.name, value(field)])));
  };
  const ready = form.needs_end ? asks(design.value) && answer.value?.reply.objective != null : true;
  const lacking = form.fields.some((field) => field.of_gap !== null && !value(field));
  return (
    <Section title={form.title}>
      <p>{form.text}</p>
      <div class="asks">
        {form.fields.map((field) => (
          <label key={field.name}>{field.title} {field.kind === "flag"
            ? <input type="checkbox" checked={value(field) === true} onChange={(event) => take(field, event.currentTarget.checked)} />
            : <NumberBox value={Number(value(field))} min={field.least ?? undefined} step={stepFor(field)} unit={field.unit || undefined} label={field.title} none={field.default === null && field.of_gap === null ? "any" : undefined} onChange={(to) => take(field, to)} />}
          </label>
        ))}
        <Run kind={form.of} label={form.button} onClick={run} disabled={!ready || lacking}>{form.button}</Run>
      </div>
      <Result of={form.of} />
    </Section>
  );
}

const stepFor = ({ kind, default: value, of_gap }: StudyField): number =>
  kind === "count" ? (Number(value ?? 0) >= 50 ? 50 : 1) : stepOf(of_gap === null ? 10 * design.value.gap : design.value.gap / 5);

function Result({ of }: { of: string }) {
  const about = studies.value[of];
  if (!about) return null;
  const { said, study, tints, command } = about.reply;
  const mine = coloured.value && tinted.value === of;
  const colours = Object.keys(tints.values).length > 0;
  return (
    <div class={current(about) ? "result" : "result old"}>
      <p class="strong">{said.title}</p>
      <p class="quiet">{said.facts.join(" · ")}</p>
      {!current(about) && <p class="quiet">said of an earlier design</p>}
      {current(about) && Object.keys(about.reply.extra).length > 0 && (
        <p class="likely"><Button label="Set these parts' extra gaps so; undo takes it back" onClick={() => change({ extra: { ...design.value.extra, ...about.reply.extra } })} class="small main">Make them tighter</Button></p>
      )}
      {current(about) && about.reply.gap !== null && about.reply.gap !== design.value.gap && (
        <p class="likely"><Button label="Set this gap; undo takes it back" onClick={() => change({ gap: about.reply.gap! })} class="small main">Set this gap</Button></p>
      )}
      {colours && <label class="check"><input type="checkbox" checked={mine} onChange={(event) => { tinted.value = of; coloured.value = event.currentTarget.checked; }} /> colour the parts</label>}
      {mine && tints.per && <Blamebar most={Math.max(...Object.values(tints.values))} per={tints.per} />}
      <Sections of={study} />
      <Command text={command} />
    </div>
  );
}
