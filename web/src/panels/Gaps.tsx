/** All parts with the gap around each of them, and whose gap matters most. */

import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { design, extraOf, fixedNames, groupOf, pulledNames, setExtras } from "../design.ts";
import { ask } from "../session.ts";
import { answer, current, drawing, names as allNames, many, ranking, selected } from "../state.ts";
import { chooseMany, chooseToo } from "../stage/lasso.ts";
import { number, own, short } from "../words.ts";
import { NumberBox } from "../chrome/NumberBox.tsx";
import { Run } from "../chrome/Run.tsx";
import { stepOf } from "../chrome/Selection.tsx";
import { Blamebar, Colouring } from "./Ranked.tsx";
import { Section } from "./Section.tsx";

type Column = "order" | "name" | "extra" | "matters";
const PAGE = 150;

/** Of one part: its share of the sum, and what a tighter gap brings where that differs. */
function share(per: string, one?: { percent: number; mm_per_mm: number; tighter: number }): string {
  if (!one) return "";
  const other = Math.abs(one.tighter - one.mm_per_mm) > 1e-3 * Math.abs(one.mm_per_mm);
  return `${number(one.percent, 3)} % of the sum${other ? `; ${number(one.tighter, 3)} ${per} if tighter` : ""}`;
}

export function Gaps() {
  const column = useSignal<Column>("order");
  const down = useSignal(true);
  const most = useSignal(PAGE);
  const wanted = useSignal("");
  const table = useRef<HTMLTableElement>(null);
  const about = ranking.value;
  const order = (next: Column): void => {
    if (column.value === next) down.value = !down.value;
    else {
      column.value = next;
      down.value = next !== "name";
    }
  };
  useEffect(() => {
    if (about) [column.value, down.value] = ["matters", true];
  }, [about]);
  const chosen = selected.value;
  useEffect(() => {
    table.current?.querySelector("[aria-selected=true]")?.scrollIntoView({ block: "nearest" });
  }, [chosen]);
  const matters = (name: string): number => (about && own(about.reply.parts, name)?.mm_per_mm) ?? 0;
  const names = allNames.value.filter((name) => name.toLowerCase().includes(wanted.value.toLowerCase()));
  const sign = down.value ? -1 : 1;
  if (column.value === "name") names.sort((a, b) => sign * a.localeCompare(b, undefined, { numeric: true }));
  if (column.value === "extra") names.sort((a, b) => sign * (extraOf(a) - extraOf(b)));
  if (column.value === "matters") names.sort((a, b) => sign * (matters(a) - matters(b)));
  const values = about ? Object.values(about.reply.parts).map((one) => Math.abs(one.mm_per_mm)) : [];
  const largest = Math.max(...values, 1e-12);
  const heading = (key: Column, words: string, hint: string) => (
    <th scope="col" aria-sort={column.value === key ? (down.value ? "descending" : "ascending") : "none"}>
      <button type="button" title={hint} onClick={() => order(key)}>{words}</button>
    </th>
  );
  return (
    <Section title="Whose gap matters most?">
      <p>How much further the answer goes for each mm of extra gap around one part.</p>
      <div class="asks">
        <Run kind="rank" label="Rank the gaps of all parts" onClick={() => void ask("rank", { design: design.peek() })} disabled={!answer.value || answer.value.reply.objective === null}>Rank</Run>
        {about && <Colouring />}
      </div>
      {about && (
        <>
          <Blamebar most={largest} per={about.reply.per} />
          {!current(about) && <p class="quiet">ranked for an earlier design</p>}
          {about.reply.note && <p class="quiet">{about.reply.note}</p>}
        </>
      )}
      {drawing.value!.parts.length > 12 && (
        <input class="search" type="search" placeholder="find a part" aria-label="find a part" value={wanted.value} onInput={(event) => (wanted.value = event.currentTarget.value)} />
      )}
      <table class="parts" ref={table}>
        <thead><tr>{heading("name", "part", "by name")}{heading("extra", "extra gap", "by extra gap")}{about && heading("matters", about.reply.per.replace(" of gap", ""), "by importance")}</tr></thead>
        <tbody>
          {names.slice(0, most.value).map((name) => (
            <tr key={name} aria-selected={name === chosen}>
              <td><div>
                <input type="checkbox" aria-label={`choose ${name} too`} checked={many.value.has(name) || name === chosen} onChange={() => chooseToo(name)} />
                <button type="button" class="link" onClick={() => chooseMany([name])}>
                  <i class={`dot ${fixedNames.value.has(name) ? "fixed" : pulledNames.value.has(name) ? "pulled" : ""}`} />
                  {short(name, 18)}
                  {groupOf(name) && <span class="quiet"> glued</span>}
                </button>
              </div></td>
              <td><NumberBox value={extraOf(name)} step={stepOf(design.value.gap)} unit="mm" label={`extra gap around ${name}`} onChange={(value) => setExtras([name], value)} /></td>
              {about && <td class="bar" title={share(about.reply.per, own(about.reply.parts, name))}><meter min={0} max={largest} value={Math.abs(matters(name))} aria-label="importance" /><span>{number(matters(name), 3)}</span></td>}
            </tr>
          ))}
        </tbody>
      </table>
      {names.length > most.value && <button type="button" class="link" onClick={() => (most.value += 4 * PAGE)}>show more of {names.length}</button>}
    </Section>
  );
}
