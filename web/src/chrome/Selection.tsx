/** What can be done with the chosen part. */

import { design, extraOf, fixAll, fixedNames, glueAll, goals, groupOf, inSpace, jointGap, pinned, pulledNames, setExtras, setJointGap, settle, togglePinned, togglePull, toggleTwist, unglue } from "../design.ts";
import { askModes, askReach, fixOrNot } from "../session.ts";
import { measuring, picked } from "../stage/measure.ts";
import { along, farOf, place, playing, shown, turnOf } from "../motion.ts";
import { isTwist } from "../protocol.ts";
import { current, standalone, drawing, extent, gluing, indexOf, many, names, outlined, ranking, reach, selected } from "../state.ts";
import { chooseMany, lassoing } from "../stage/lasso.ts";
import { number, short } from "../words.ts";
import { Button } from "./Button.tsx";
import { NumberBox } from "./NumberBox.tsx";

export function glueOrNot(name: string): void {
  if (groupOf(name)) unglue(name);
  else gluing.value = gluing.value ? null : name;
}

export function Selection() {
  const name = selected.value;
  if (standalone.value) return null;
  if (gluing.value) return <div class="selection hint" role="status">Choose the part to glue to {short(gluing.value)} <button type="button" class="link" onClick={() => (gluing.value = null)}>cancel</button></div>;
  if (!drawing.value) return null;
  if (measuring.value) return <p class="selection hint" role="status">{["Press an edge or a corner", "Press another one: the clearance between them is shown and follows the motion", "Press again to measure something else, Escape to end"][picked.value.length]}</p>;
  if (lassoing.value) return <p class="selection hint" role="status">Draw a line round the parts to choose</p>;
  if (many.value.size) return <Several names={[...many.value]} />;
  if (!name) return <p class="selection hint">Drag a part to feel where it stops. Press one to fix, pull, glue or loosen it.</p>;
  if (inSpace()) return <InSpace name={name} />;
  return (
    <div class="selection" role="toolbar" aria-label={`part ${name}`}>
      <Who name={name} note={reached(name) ? reach.value!.reply.words : ""} />
      <Button icon="fix" label="Fix this part" keyName="F" onClick={() => fixOrNot(name)} pressed={fixedNames.value.has(name)}>Fix</Button>
      <Button icon="pull" label="Pull this part" keyName="P" onClick={() => togglePull(name)} pressed={pulledNames.value.has(name)}>Pull</Button>
      <Button icon="glue" label="Glue to another part" keyName="G" onClick={() => glueOrNot(name)} pressed={groupOf(name) !== undefined}>Glue</Button>
      <Button icon="needle" label="Pin: it stands while others are dragged" keyName="N" onClick={() => togglePinned(name)} disabled={fixedNames.value.has(name)} pressed={pinned.value.has(name)}>Pin</Button>
      <Button icon="wiggle" label="Show how it can still move" keyName="W" onClick={() => askModes(name)} disabled={fixedNames.value.has(name)}>Wiggle</Button>
      <Button icon="reach" label="Show where it can be brought" keyName="R" onClick={() => askReach(name)} disabled={fixedNames.value.has(name)} pressed={reached(name)}>Reach</Button>
      <ExtraGap name={name} />
    </div>
  );
}

/** Name of the chosen part, and below it what is known of it. */
function Who({ name, note }: { name: string; note: string }) {
  return (
    <span class="who">
      <span class="name" title={name}>{short(name, 18)}</span>
      <span class="quiet note" role="status" title={note}>{note}</span>
    </span>
  );
}

/** Outlines a part alone, so that one sees past it; or fills it again. */
export function seePast(name: string): void {
  const next = new Set(outlined.peek());
  if (!next.delete(name)) next.add(name);
  outlined.value = next;
}

function InSpace({ name }: { name: string }) {
  const { frames } = shown.value;
  const motion = frames && frames.n === names.value.length ? along(frames, place.value * (shown.value.until ?? 1)) : null;
  const i = indexOf.value.get(name)!;
  const far = motion ? farOf(motion, i, 7) : 0;
  const turned = motion ? (turnOf(motion, i, 7) * 180) / Math.PI : 0;
  const tiny = 1e-6 * extent.value.radius;
  const moved = [...(far > tiny ? [`centre ${number(far, 3)} mm`] : []), ...(turned > 1e-4 ? [`turned ${number(turned, 3)}°`] : [])].join(", ");
  const twisted = goals.value.some((goal) => goal.part === name && isTwist(goal));
  return (
    <div class="selection" role="toolbar" aria-label={`part ${name}`}>
      <Who name={name} note={playing.value ? "" : moved || "at rest"} />
      <Button icon="fix" label="Fix this part" keyName="F" onClick={() => fixOrNot(name)} pressed={fixedNames.value.has(name)}>Fix</Button>
      <Button icon="pull" label="Pull this part" keyName="P" onClick={() => togglePull(name)} pressed={pulledNames.value.has(name) && !twisted}>Pull</Button>
      <Button icon="twist" label="Twist this part" keyName="T" onClick={() => toggleTwist(name)} pressed={twisted}>Twist</Button>
      <Button icon="glue" label="Glue to another part" keyName="G" onClick={() => glueOrNot(name)} pressed={groupOf(name) !== undefined}>Glue</Button>
      <Button icon="needle" label="Pin: it stands while others are dragged" keyName="N" onClick={() => togglePinned(name)} disabled={fixedNames.value.has(name)} pressed={pinned.value.has(name)}>Pin</Button>
      <Button icon="wiggle" label="Show how it can still move" keyName="W" onClick={() => askModes(name)} disabled={fixedNames.value.has(name)}>Wiggle</Button>
      <Button icon="see" label="Outline it alone, to see past it" keyName="H" onClick={() => seePast(name)} pressed={outlined.value.has(name)}>See past</Button>
      <ExtraGap name={name} />
    </div>
  );
}

const reached = (name: string): boolean => reach.value !== null && reach.value.design === design.value && reach.value.reply.part === name;

/** What can be done with many parts at once. */
function Several({ names }: { names: string[] }) {
  const fixed = names.filter((one) => fixedNames.value.has(one));
  const gap = extraOf(names[0]!);
  return (
    <div class="selection" role="toolbar" aria-label={`${names.length} parts`}>
      <span class="name" title={names.join(", ")}>{names.length === 2 ? names.map((one) => short(one, 12)).join(" | ") : `${names.length} parts`}</span>
      <Button icon="fix" label="Fix these parts" onClick={() => fixAll(names, fixed.length < names.length)} pressed={fixed.length === names.length}>Fix</Button>
      <Button icon="glue" label="Glue these parts to each other" onClick={() => glueAll(names)}>Glue</Button>
      <div class="extra named">
        <span aria-hidden="true">extra gap</span>
        <NumberBox value={gap} step={stepOf(design.value.gap || extent.value.radius / 50)} unit="mm" label="extra gap around each of these parts" onChange={(value) => setExtras(names, value)} />
      </div>
      {names.length === 2 && <JointGap pair={names as [string, string]} />}
      <Button icon="close" label="Choose none" onClick={() => chooseMany([])} class="small" />
    </div>
  );
}

/** The gap of one part: a slider with its box in step; to the left of the middle the part fits tighter than the others. */
function ExtraGap({ name }: { name: string }) {
  const extra = extraOf(name);
  const step = stepOf(design.value.gap || extent.value.radius / 50);
  const most = 10 * step * Math.max(1, Math.ceil(Math.abs(extra) / (10 * step) - 1e-9));
  const slide = (value: number): void => setExtras([name], Number((Math.round(value / step) * step).toPrecision(6)), `extra ${name}`);
  return (
    <div class="extra" title="extra gap around this part alone">
      <span aria-hidden="true">extra gap</span>
      <input
        type="range" min={-most} max={most} step={step} value={extra} aria-label={`extra gap around ${name}`} aria-valuetext={`${number(extra)} mm`}
        onInput={(event) => slide(Number(event.currentTarget.value))} onPointerDown={settle} onPointerUp={settle} onBlur={settle}
      />
      <NumberBox value={extra} step={step} unit="mm" label={`extra gap around ${name}`} onChange={(value) => setExtras([name], value)} />
    </div>
  );
}

/** The gap of the joint of two parts: that of all others until it has one of its own. */
function JointGap({ pair: [a, b] }: { pair: [string, string] }) {
  const own = jointGap(a, b);
  const { gap } = design.value;
  const step = stepOf(gap || extent.value.radius / 50);
  const value = own ?? gap;
  const most = 10 * step * Math.max(2, Math.ceil(value / (10 * step) - 1e-9) + 1);
  const about = ranking.value && current(ranking.value) ? ranking.value.reply : null;
  const matters = about?.joints.find(({ parts }) => parts.includes(a) && parts.includes(b));
  const slide = (to: number): void => setJointGap(a, b, Number((Math.round(to / step) * step).toPrecision(6)), `joint ${a}|${b}`);
  return (
    <div class="extra named" title="the gap between these two parts alone">
      <span aria-hidden="true">gap between</span>
      <input
        type="range" min={0} max={most} step={step} value={value} aria-label={`gap between ${a} and ${b}`} aria-valuetext={`${number(value)} mm`}
        onInput={(event) => slide(Number(event.currentTarget.value))} onPointerDown={settle} onPointerUp={settle} onBlur={settle}
      />
      <NumberBox value={value} min={0} step={step} unit="mm" label={`gap between ${a} and ${b}`} onChange={(to) => setJointGap(a, b, to)} />
      {matters && <span class="quiet" title="what this joint's gap is worth to the answer">{number(matters.mm_per_mm, 3)} {about!.per}</span>}
      {own !== null && <button type="button" class="link" aria-label={`as all: give ${a} and ${b} the gap of all others`} onClick={() => setJointGap(a, b, null)}>as all</button>}
    </div>
  );
}

/** A round step that is a small share of the gap. */
export function stepOf(gap: number): number {
  const power = 10 ** Math.floor(Math.log10(Math.max(gap, 1e-6) / 10));
  const lead = Math.max(gap, 1e-6) / 10 / power;
  return power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
}
