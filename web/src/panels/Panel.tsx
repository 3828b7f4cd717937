/** The right panel, on a phone a sheet below the canvas: tabs with one panel each. */

import type { ComponentType } from "preact";
import { baked, checked, drawing, ranking, sheetOpen, space, type Tab, tab } from "../state.ts";
import { Answer } from "./Answer.tsx";
import { Apart } from "./Apart.tsx";
import { Gaps } from "./Gaps.tsx";
import { Space } from "./Space.tsx";
import { Sure } from "./Sure.tsx";

const TABS: [Tab, string, ComponentType][] = [
  ["answer", "Answer", Answer], ["gaps", "Gaps", Gaps], ["apart", "Come apart", Apart], ["space", "Free space", Space], ["sure", "How sure", Sure],
];

export function Panel() {
  if (!drawing.value) return null;
  const stored: Record<Tab, boolean> = {
    answer: true, gaps: !baked.value || ranking.value !== null, apart: !baked.value || checked.value !== null,
    space: !baked.value || space.value !== null, sure: true,
  };
  const tabs = TABS.filter(([name]) => stored[name]);
  const Shown = (tabs.find(([name]) => name === tab.value) ?? tabs[0]!)[2];
  const choose = (name: Tab): void => {
    if (tab.value === name && sheetOpen.value) sheetOpen.value = false;
    else {
      tab.value = name;
      sheetOpen.value = true;
    }
  };
  const keys = (event: KeyboardEvent): void => {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!by) return;
    event.preventDefault();
    const at = tabs.findIndex(([name]) => name === tab.value);
    tab.value = tabs[(at + by + tabs.length) % tabs.length]![0];
    requestAnimationFrame(() => document.getElementById(`tab-${tab.value}`)?.focus());
  };
  return (
    <aside class="panel" data-open={sheetOpen.value} aria-label="answers">
      <div class="tabs" role="tablist" aria-label="answers" onKeyDown={keys}>
        {tabs.map(([name, words]) => (
          <button
            key={name} id={`tab-${name}`} type="button" role="tab" aria-selected={tab.value === name} aria-controls="tabpanel"
            tabIndex={tab.value === name ? 0 : -1} onClick={() => choose(name)}
          >{words}</button>
        ))}
      </div>
      <div class="tabpanel" id="tabpanel" role="tabpanel" aria-labelledby={`tab-${tab.value}`} tabIndex={-1}><Shown /></div>
    </aside>
  );
}
