/** The right panel, on a phone a sheet below the canvas: tabs with one panel each. */

import { computed } from "@preact/signals";
import { inSpace } from "../design.ts";
import type { ComponentType } from "preact";
import { ofSheet } from "../sheetState.ts";
import { answer, atStart, standalone, checked, drawing, printing, ranking, sheetOpen, space, type Tab, tab, trouble } from "../state.ts";
import { Answer } from "./Answer.tsx";
import { Apart } from "./Apart.tsx";
import { Findings, Unopened } from "./Findings.tsx";
import { Gaps } from "./Gaps.tsx";
import { Joints, Ranked } from "./Ranked.tsx";
import { Sheet } from "./Sheet.tsx";
import { Space } from "./Space.tsx";
import { Study } from "./Study.tsx";
import { Sure } from "./Sure.tsx";
import { Vary } from "./Vary.tsx";

interface Page { name: Tab; words: string; Shown: ComponentType }

const GapsAndJoints = () => <><Gaps /><Joints /></>;

/** The panels of the live page; of one that carries what was found, those that have something to say. */
export const pages = computed<Page[]>(() => {
  const page = (name: Tab, words: string, Shown: ComponentType, there: boolean = true): Page[] => (there ? [{ name, words, Shown }] : []);
  const told = standalone.value;
  if (!told) {
    return [...page("answer", "Answer", Answer), ...page("gaps", "Gaps", GapsAndJoints), ...page("vary", "Vary", Vary), ...page("apart", "Come apart", Apart), ...page("space", "Free space", Space, !inSpace()), ...page("sure", "How sure", Sure), ...page("sheet", "Sheet", Sheet, !inSpace())];
  }
  return [
    ...page("answer", "Answer", Answer, answer.value !== null), ...page("gaps", "Whose gap", Ranked, ranking.value !== null),
    ...page("apart", "Come apart", Apart, checked.value !== null), ...page("space", "Free space", Space, space.value !== null),
    ...page("study", told.study?.tab ?? "", Study, told.study !== null), ...page("sure", "How sure", Sure, answer.value !== null || checked.value !== null),
  ];
});

export function Panel() {
  if (!drawing.value) return null;
  const tabs = pages.value;
  const open = tabs.find(({ name }) => name === tab.value) ?? tabs[0]!;
  if (printing.value) return <aside class="panel" aria-label="answers">{tabs.map(({ name, Shown }) => <div class="tabpanel" key={name}><Shown /></div>)}</aside>;
  const choose = (name: Tab): void => {
    if (open.name === name && sheetOpen.value) sheetOpen.value = false;
    else {
      tab.value = name;
      sheetOpen.value = true;
      requestAnimationFrame(() => document.querySelector(".panel")?.scrollIntoView({ block: "nearest" })); // below a low screen's edge
    }
  };
  const keys = (event: KeyboardEvent): void => {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!by) return;
    event.preventDefault();
    tab.value = tabs[(tabs.indexOf(open) + by + tabs.length) % tabs.length]!.name;
    requestAnimationFrame(() => document.getElementById(`tab-${tab.value}`)?.focus());
  };
  return (
    <aside class="panel" inert={atStart.value} data-open={sheetOpen.value} aria-label="answers">
      <div class="tabs" role="tablist" aria-label="answers" onKeyDown={keys}>
        {tabs.map(({ name, words }) => (
          <button
            key={name} id={`tab-${name}`} type="button" role="tab" aria-selected={open.name === name} aria-controls="tabpanel"
            tabIndex={open.name === name ? 0 : -1} onClick={() => choose(name)}
          >{words}</button>
        ))}
      </div>
      <Unopened />
      {(open.name !== "sheet" || ofSheet(trouble.value)) && <Findings />}
      <div class="tabpanel" id="tabpanel" key={open.name} role="tabpanel" aria-labelledby={`tab-${open.name}`} tabIndex={-1}><open.Shown /></div>
    </aside>
  );
}
