/** What can be done with the chosen part. */

import { design, fixedNames, groupOf, pulledNames, setExtra, toggleFixed, togglePull, unglue } from "../design.ts";
import { ask } from "../session.ts";
import { baked, gluing, selected } from "../state.ts";
import { short } from "../words.ts";
import { Button } from "./Button.tsx";
import { NumberBox } from "./NumberBox.tsx";

export function wiggle(part?: string): void {
  ask("wiggle", part ? { design: design.peek(), part } : { design: design.peek() });
}

export function glueOrNot(name: string): void {
  if (groupOf(name)) unglue(name);
  else gluing.value = gluing.value ? null : name;
}

export function Selection() {
  const name = selected.value;
  if (baked.value) return null;
  if (gluing.value) return <div class="selection hint" role="status">Choose the part to glue to {short(gluing.value)} <button type="button" class="link" onClick={() => (gluing.value = null)}>cancel</button></div>;
  if (!name) return null;
  const extra = design.value.extra[name] ?? 0;
  return (
    <div class="selection" role="toolbar" aria-label={`part ${name}`}>
      <span class="name" title={name}>{short(name, 18)}</span>
      <Button icon="fix" label="Fix this part" keyName="F" onClick={() => toggleFixed(name)} pressed={fixedNames.value.has(name)}>Fix</Button>
      <Button icon="pull" label="Pull this part" keyName="P" onClick={() => togglePull(name)} pressed={pulledNames.value.has(name)}>Pull</Button>
      <Button icon="glue" label="Glue to another part" keyName="G" onClick={() => glueOrNot(name)} pressed={groupOf(name) !== undefined}>Glue</Button>
      <Button icon="wiggle" label="Show how it can still move" keyName="W" onClick={() => wiggle(name)}>Wiggle</Button>
      <label class="extra" title="extra gap around this part alone">
        <span>extra gap</span>
        <NumberBox value={extra} step={stepOf(design.value.gap)} unit="mm" label={`extra gap around ${name}`} onChange={(value) => setExtra(name, value)} />
      </label>
    </div>
  );
}

/** A round step that is a small share of the gap. */
export function stepOf(gap: number): number {
  const power = 10 ** Math.floor(Math.log10(Math.max(gap, 1e-6) / 10));
  const lead = Math.max(gap, 1e-6) / 10 / power;
  return power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
}
