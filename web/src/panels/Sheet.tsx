/** From a cutting sheet to the thing put together: what is asked, what was found, what was said by hand, and how it goes on. */

import { useSignal } from "@preact/signals";
import { Button } from "../chrome/Button.tsx";
import { NumberBox } from "../chrome/NumberBox.tsx";
import { Run } from "../chrome/Run.tsx";
import * as sheet from "../sheet.ts";
import { drawing, running } from "../state.ts";
import { number } from "../words.ts";
import { Command } from "./Command.tsx";
import { Section } from "./Section.tsx";

const SIDES = ["left", "right", "bottom", "top"] as const;
const TOOLS: { name: sheet.Tool; words: string; how: string }[] = [
  { name: "join", words: "Join", how: "Press two edges that hold each other." },
  { name: "lay", words: "Lay", how: "Press the loose panel where it touches, then the panel that it lies on, there. On an outline means the edge." },
  { name: "flush", words: "Flush", how: "Press two edges that end in one plane." },
  { name: "body", words: "One body", how: "Press all panels of one body, then One body of these." },
  { name: "skip", words: "No part", how: "Press what is no part of it, such as a template." },
];

export function Sheet() {
  const found = sheet.assembled.value;
  return (
    <>
      <Section title="Put the panels together">
        <p>For a cutting sheet whose panels are plates: their joints are found, and they stand in space.</p>
        <div class="asks">
          <label>thickness <NumberBox value={sheet.thickness.value} min={0.01} step={0.1} unit="mm" label="thickness of the material" onChange={(v) => (sheet.thickness.value = v)} /></label>
          <label>burn <NumberBox value={sheet.burn.value ?? found?.burn ?? 0} min={0} step={0.05} unit="mm" label="by how much outlines are drawn larger" onChange={(v) => (sheet.burn.value = v)} /></label>
          <Run kind="assemble" label="Put the panels together" onClick={sheet.assemble} disabled={!drawing.value}>Assemble</Run>
        </div>
      </Section>
      {found && <><Found /><Hinted /><GoOn /><Command text={found.command} /></>}
    </>
  );
}

function Found() {
  const { headline, certainty, doubts, joints, panels, notes, thickness, burn } = sheet.assembled.value!;
  const other = thickness !== sheet.thickness.value || burn !== (sheet.burn.value ?? burn);
  const left = panels.filter(({ state }) => state !== "placed");
  return (
    <Section title="What was found">
      {other && <p class="quiet" role="status">These are of a thickness of {number(thickness)} mm and a burn of {number(burn)} mm; Assemble takes the other.</p>}
      <p class="verdict" data-verdict={certainty === "sure" ? "interlocked" : ""} role="status" id="assembled">{headline}</p>
      {doubts.length > 0 && <ul class="rows" aria-label="why it is not sure">{doubts.map((doubt) => <li key={doubt}>{doubt}</li>)}</ul>}
      {left.length > 0 && (
        <ul class="rows" aria-label="not placed">
          {left.map((panel) => (
            <li class="row" key={panel.name}>
              <button type="button" class="link name" onClick={() => (sheet.chosen.value = panel.name)}>{panel.name}</button>
              <span class="quiet">{panel.state === "loose" ? "loose" : "not placed"}</span>
              <Button
                label={`Lay ${panel.name} on another panel`} class="small"
                onClick={() => { sheet.setTool("lay"); sheet.press({ panel: panel.name, edge: panel.name, at: sheet.sidePoint(panel, "") }); }}
              >Lay it</Button>
            </li>
          ))}
        </ul>
      )}
      <details class="note">
        <summary>{joints.length} joints</summary>
        <ul class="rows">{joints.map(({ name, panels: two, flanks }) => <li key={name}><b>{name}</b> {two.join(" – ")} <span class="quiet">{flanks} flanks</span></li>)}</ul>
      </details>
      {notes.length > 0 && <ul class="rows quiet" aria-label="notes">{notes.map((note) => <li key={note}>{note}</li>)}</ul>}
    </Section>
  );
}

function Hinted() {
  const tool = TOOLS.find(({ name }) => name === sheet.tool.value)!;
  const { picked } = sheet;
  const poses = sheet.poses.value;
  return (
    <Section title="What you know" side={<Button icon="undo" label="Take the last hint back" onClick={sheet.undoHint} disabled={!sheet.canUndo.value} class="small" />}>
      <div class="tools" role="group" aria-label="what a press on the sheet says">
        {TOOLS.map(({ name, words }) => <Button key={name} label={words} pressed={name === tool.name} onClick={() => sheet.setTool(name)} class="small">{words}</Button>)}
      </div>
      <p class="quiet" role="status">{picked.value.length ? `${picked.value.map((one) => (tool.name === "body" ? one.panel : one.edge)).join(", ")} chosen. ` : ""}{tool.how}</p>
      {tool.name === "body" && <p><Button label="The chosen panels make one body" onClick={sheet.together} disabled={picked.value.length < 2} class="small main">One body of these</Button></p>}
      {(tool.name === "join" || tool.name === "flush" || tool.name === "lay") && <ByName key={tool.name} kind={tool.name} />}
      {poses && (
        <p class="row">
          <span class="grow">{poses.plates[0]!.panel}: pose {poses.taken + 1} of {poses.plates.length}</span>
          <Button label="Another pose" onClick={() => sheet.take(poses.taken + 1)} disabled={poses.plates.length < 2 || running.value.has("assemble")} class="small">Another pose</Button>
        </p>
      )}
      <ul class="rows" aria-label="hints">
        {sheet.said.value.map(({ kind, k, words }) => (
          <li class="row" key={`${kind}${k}`}><span class="grow">{words}</span><Button icon="close" label={`Take back: ${words}`} onClick={() => sheet.drop(kind, k)} class="small" /></li>
        ))}
      </ul>
      <p><Button label="Save the hints as TOML, for --hints" onClick={sheet.saveHints} disabled={sheet.count.value === 0} class="small">Save hints</Button></p>
    </Section>
  );
}

/** The same as two presses on the sheet, by names of panels and sides. */
function ByName({ kind }: { kind: "join" | "flush" | "lay" }) {
  const panels = sheet.assembled.value!.panels;
  const names = panels.map(({ name }) => name);
  const loose = panels.find(({ state }) => state !== "placed")?.name ?? names[0]!;
  const ends = [
    { panel: useSignal(loose), side: useSignal<string>("top") },
    { panel: useSignal(names.find((name) => name !== loose) ?? loose), side: useSignal<string>("top") },
  ];
  const words = { join: "Join these", flush: "Make these flush", lay: "Lay it there" }[kind];
  const done = (): void => {
    const [a, b] = ends.map(({ panel, side }) => ({
      panel: panel.value, edge: `${panel.value}:${side.value}`, at: sheet.sidePoint(sheet.panels.peek().get(panel.value)!, side.value),
    })) as [sheet.Picked, sheet.Picked];
    if (kind === "lay") sheet.layOn(a, b);
    else sheet.pair(kind, a.edge, b.edge);
  };
  return (
    <details class="note">
      <summary>By name</summary>
      <div class="asks">
        {ends.map(({ panel, side }, k) => (
          <span class="row" key={k}>
            <select aria-label={k ? "second panel" : "first panel"} value={panel.value} onChange={(event) => (panel.value = event.currentTarget.value)}>
              {names.map((name) => <option key={name} value={name}>{name}</option>)}
            </select>
            <select aria-label={k ? "second side" : "first side"} value={side.value} onChange={(event) => (side.value = event.currentTarget.value)}>
              {[...SIDES, ...(kind === "lay" ? ["face"] : [])].map((name) => <option key={name} value={name}>{name}</option>)}
            </select>
          </span>
        ))}
        <Button label={words} onClick={done} class="small main" disabled={ends[0]!.panel.value === ends[1]!.panel.value}>{words}</Button>
      </div>
    </details>
  );
}

function GoOn() {
  const { certainty, file, panels } = sheet.assembled.value!;
  if (panels.every(({ state }) => state !== "placed")) return null;
  return (
    <Section title="How it goes on">
      <p>{certainty === "sure" ? "Ask how the parts move, and whether it comes apart." : "It is not sure that this is how it belongs: look at it first."}</p>
      <div class="asks">
        <Button label="Open what was put together in space" onClick={sheet.goOn} disabled={!file} class={certainty === "sure" ? "main" : ""}>Go on in space</Button>
        <Button label="Save the assembly file" onClick={sheet.saveAssembly} disabled={!file}>Save assembly</Button>
      </div>
    </Section>
  );
}
