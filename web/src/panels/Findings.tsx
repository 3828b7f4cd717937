/** Everything that is wrong with the design, each with its place in the picture and what would put it right. */

import { change } from "../design.ts";
import type { Fault, Mend } from "../protocol.ts";
import { findings, pointed, trouble, unopened } from "../state.ts";
import { Button } from "../chrome/Button.tsx";

export const mend = ({ words: _, ...changed }: Mend): void => {
  pointed.value = null;
  change(changed);
};

export function Findings() {
  const all = findings.value;
  if (all.length === 0) return null;
  return (
    <section class={all.every((one) => one.missing) ? "findings missing" : "findings"} aria-label="what is wrong" role="alert">
      <header><h2>{heading(all)}</h2><Button icon="close" label="Close the list" onClick={() => (findings.value = [])} class="small" /></header>
      <ul>{all.map((one) => <Row key={one.words} finding={one} />)}</ul>
    </section>
  );
}

/** Nothing is wrong with a drawing of which only something is not set yet. */
function heading(all: readonly Fault[]): string {
  if (trouble.value === "line") return "No server";
  const words = all.every((one) => one.missing) ? "to set first" : "to put right";
  return all.length === 1 ? `One thing ${words}` : `${all.length} things ${words}`;
}

/** Why a file could not be opened. */
export function Unopened() {
  if (unopened.value.length === 0) return null;
  return (
    <section class="findings" aria-label="what could not be opened" role="alert">
      <header><h2>It could not be opened</h2><Button icon="close" label="Close" onClick={() => (unopened.value = [])} class="small" /></header>
      <ul>{unopened.value.map((words) => <li key={words}><p>{words}</p></li>)}</ul>
    </section>
  );
}

function Row({ finding }: { finding: Fault }) {
  const { words, parts, point, mends } = finding;
  const shown = pointed.value === finding;
  return (
    <li>
      <p>{words}</p>
      {(mends.length > 0 || point || parts.length > 0) && (
        <div class="mends">
          {mends.map((one, i) => <Button key={one.words} label={one.words} onClick={() => mend(one)} class={`small ${i ? "" : "main"}`}>{one.words}</Button>)}
          {(point || parts.length > 0) && <Button label={shown ? "Do not show it" : "Show it in the picture"} onClick={() => (pointed.value = shown ? null : finding)} pressed={shown} class="small">Show</Button>}
        </div>
      )}
    </li>
  );
}
