/** What is asked, what was found, and what holds it. */

import { computed } from "@preact/signals";
import { useMemo, useRef } from "preact/hooks";
import { asks, change, design, goals, inSpace, pinned, removeGoal, setGoal, setJointGap, toggleFixed, togglePinned, unglue } from "../design.ts";
import { type Cell, type ContactEntry, type Goal, isPull, isSpatialPull, isTurn, isTwist, type Point, type Triple } from "../protocol.ts";
import { answer, standalone, dragged, drawing, extent, findings, highlit, names, selected, tab } from "../state.ts";
import { columns, end, farOf, shown, turnOf } from "../motion.ts";
import { ask, degrees, few, number, short, towards } from "../words.ts";
import { Button } from "../chrome/Button.tsx";
import { NumberBox } from "../chrome/NumberBox.tsx";
import { Explain, FORCE } from "../chrome/Meaning.tsx";
import { MadeOf } from "./MadeOf.tsx";
import { ReadAs } from "./ReadAs.tsx";
import { AsOf } from "./AsOf.tsx";
import { Command } from "./Command.tsx";
import { Section } from "./Section.tsx";
import { Table } from "./Table.tsx";

export function Answer() {
  const about = answer.value;
  return (
    <>
      <OnSheet />
      <MadeOf />
      <Standing />
      <Asked />
      <Gap />
      <ReadAs />
      {about && (
        <>
          <AsOf about={about} />
          {about.reply.leaves.length > 0 && <Section title="Leaves"><p>{few(about.reply.leaves, 12)}</p></Section>}
          {["mode", "escape"].includes(shown.value.what) ? <p class="quiet">What holds the answer is listed while the answer is shown.</p> : <><Held /><Moved /></>}
          <Command text={about.reply.command} />
        </>
      )}
    </>
  );
}

/** Where parts lie apart they are perhaps panels of something that is to be put together first. */
function OnSheet() {
  if (!drawing.value?.apart || inSpace() || standalone.value) return null;
  return (
    <Section title="Is this a cutting sheet?">
      <p>No part is near another one. Panels of a box or a stool can be put together first.</p>
      <p class="likely"><Button label="Put the panels together" onClick={() => (tab.value = "sheet")} class="small main">Put them together</Button></p>
    </Section>
  );
}

const WHOLE: Record<string, string> = { closer: "neighbours closer", translation: "sum of squared translations", weight: "every part is pulled down at its centroid by its volume" };

function Asked() {
  const whole = design.value.goals;
  if (standalone.value && !asks(design.value)) return null;
  return (
    <Section title="What is pulled" step={standalone.value ? undefined : 2} done={asks(design.value)}>
      {typeof whole === "string" && <p>{WHOLE[whole]}</p>}
      {inSpace() && !standalone.value && (
        <p class="likely"><label><input type="checkbox" checked={whole === "weight"} onChange={(event) => change({ goals: event.currentTarget.checked ? "weight" : [] })} /> everything sinks by its weight, in -z</label></p>
      )}
      {typeof whole !== "string" && goals.value.length === 0 && <p class="quiet">Nothing yet. Press a part in the picture, then Pull.</p>}
      <ul class="rows">{goals.value.map((goal, i) => <GoalRow key={i} goal={goal} index={i} />)}</ul>
    </Section>
  );
}

function Gap() {
  if (standalone.value) return null;
  const wrong = findings.value.some((one) => one.about === "gap");
  return (
    <Section title="The gap" step={3} done={!wrong && drawing.value !== null && answer.value !== null} side={<span>{number(design.value.gap)} mm</span>}>
      {wrong && <p class="quiet">Parts need room to move: the gap is taken off all outlines, half on each side.</p>}
      {(design.value.gaps ?? []).length > 0 && (
        <ul class="chips" aria-label="gaps of single joints">
          {design.value.gaps!.slice(0, 40).map(([a, b, gap]) => <Chip key={`${a}|${b}`} class="" name={`${short(a, 12)} | ${short(b, 12)}: ${number(gap)} mm`} onRemove={() => setJointGap(a, b, null)} words={`give ${a} and ${b} the gap of all others`} />)}
        </ul>
      )}
    </Section>
  );
}

const AXES: Record<string, Triple> = { "+x": [1, 0, 0], "-x": [-1, 0, 0], "+y": [0, 1, 0], "-y": [0, -1, 0], "+z": [0, 0, 1], "-z": [0, 0, -1] };

/** What is asked of a part in space: a pull along a direction, or a twist about it. */
function SpatialGoalRow({ goal, index, direction }: { goal: Goal; index: number; direction: Triple }) {
  const twist = isTwist(goal);
  const put = (next: Triple, turn = twist): void => setGoal(index, { part: goal.part, ...(turn ? { turn: next } : { direction: next, point: goal.point ?? null }) });
  const named = towards(direction);
  return (
    <li class="row spatial">
      <button type="button" class="link name" onClick={() => (selected.value = goal.part)}>{short(goal.part)}</button>
      <select aria-label={`what is asked of ${goal.part}`} value={twist ? "twist" : "pull"} onChange={(event) => put(direction, event.currentTarget.value === "twist")}>
        <option value="pull">pull</option><option value="twist">twist</option>
      </select>
      <select aria-label={`axis for ${goal.part}`} value={AXES[named] ? named : "own"} onChange={(event) => put(AXES[event.currentTarget.value] ?? [1, 1, 1])}>
        {Object.keys(AXES).map((name) => <option key={name} value={name}>{twist ? "about" : "in"} {name}</option>)}
        <option value="own">other</option>
      </select>
      <Button icon="close" label={`Do not ask for ${goal.part}`} onClick={() => removeGoal(index)} class="small" />
      {!AXES[named] && (
        <span class="numbers">
          {direction.map((value, k) => (
            <NumberBox
              key={k} value={value} digits={4} step={0.1} label={`${"xyz"[k]} of the direction for ${goal.part}`}
              onChange={(to) => {
                const next = direction.map((old, j) => (j === k ? to : old)) as Triple;
                if (next.some((one) => one !== 0)) put(next);
              }}
            />
          ))}
        </span>
      )}
    </li>
  );
}

function GoalRow({ goal, index }: { goal: Goal; index: number }) {
  if (isSpatialPull(goal)) return <SpatialGoalRow goal={goal} index={index} direction={goal.direction} />;
  if (isTwist(goal)) return <SpatialGoalRow goal={goal} index={index} direction={goal.turn} />;
  const still = standalone.value !== null;
  const turned = (angle: number): Point => [Math.cos((angle * Math.PI) / 180), Math.sin((angle * Math.PI) / 180)].map((v) => Number(v.toFixed(6)) + 0) as Point;
  return (
    <li class="row">
      <button type="button" class="link name" onClick={() => (selected.value = goal.part)}>{short(goal.part)}</button>
      {still || !(isPull(goal) || isTurn(goal)) ? <span class="grow">{ask(goal).slice(isTurn(goal) ? 0 : goal.part.length)}</span> : (
        <select
          aria-label={`what is asked of ${goal.part}`} value={isPull(goal) ? "pull" : goal.turn}
          onChange={(event) => {
            const to = event.currentTarget.value;
            setGoal(index, to === "pull" ? { part: goal.part, direction: [1, 0] } : { part: goal.part, turn: to as "cw" | "ccw" });
          }}
        >
          <option value="pull">pull</option><option value="ccw">turn ccw</option><option value="cw">turn cw</option>
        </select>
      )}
      {!still && isPull(goal) && (
        <NumberBox
          value={Number(degrees(goal.direction).toFixed(3))} digits={5} step={5} unit="°" label={`direction of the pull on ${goal.part}`}
          onChange={(angle) => setGoal(index, { ...goal, direction: turned(angle) })}
        />
      )}
      {!still && <Button icon="close" label={`Do not ask for ${goal.part}`} onClick={() => removeGoal(index)} class="small" />}
    </li>
  );
}

function Standing() {
  const { fixed, glue } = design.value;
  if (standalone.value && fixed.length + glue.length === 0) return null;
  return (
    <Section title="What stands" step={standalone.value ? undefined : 1} done={fixed.length > 0}>
      {fixed.length === 0 && <p class="quiet">Nothing yet. Press a part in the picture, then Fix.</p>}
      <ul class="chips">
        {fixed.slice(0, 40).map((name) => <Chip key={name} class="fixed" name={name} onRemove={() => toggleFixed(name)} words={`let ${name} go`} />)}
        {[...pinned.value].map((name) => <Chip key={`pin ${name}`} class="fixed" name={`${name}, pinned`} onRemove={() => togglePinned(name)} words={`unpin ${name}`} />)}
        {fixed.length > 40 && <li class="quiet">and {fixed.length - 40} more</li>}
      </ul>
      {glue.length > 0 && (
        <ul class="chips" aria-label="glued">
          {glue.slice(0, 20).map((group) => <Chip key={group.join()} class="glue" name={group.map((one) => short(one, 10)).join(" + ")} onRemove={() => unglue(group[0]!)} words={`unglue ${group[0]}`} />)}
        </ul>
      )}
    </Section>
  );
}

function Chip({ name, words, onRemove, class: kind }: { name: string; words: string; onRemove: () => void; class: string }) {
  return (
    <li class={`chip ${kind}`}>
      {short(name, 26)}
      {!standalone.value && <button type="button" aria-label={words} title={words} onClick={onRemove}>×</button>}
    </li>
  );
}

const NO_CONTACTS: ContactEntry[] = [];
/** What holds the motion that is shown; null while the hand moves, until that is known. */
const holding = computed(() => {
  if (shown.value.what !== "drag") return answer.value?.reply.contacts ?? NO_CONTACTS;
  return dragged.value?.reply.settled ? dragged.value.reply.held : null;
});

/** The contacts before stand there, pale, until new ones are known: nothing jumps while the hand moves. */
function Held() {
  const known = useRef(NO_CONTACTS);
  const contacts = (known.current = holding.value ?? known.current);
  const pale = holding.value === null;
  return useMemo(() => contacts.length > 0 && (
    <Section title="What holds it" side={<span class="quiet">{contacts.length} {contacts.length === 1 ? "contact" : "contacts"}</span>}>
      <p>Where parts press on each other at the end, and how hard<Explain word="force" words={FORCE} /></p>
      <div class={pale ? "old" : ""} aria-busy={pale}>
        <Table
          columns={["between", "x mm", "y mm", ...(inSpace() ? ["z mm"] : []), "force"]} rows={contacts.map(({ parts, point, force }): Cell[] => [parts, ...point, force])}
          bar={inSpace() ? 4 : 3} onHover={(i) => (highlit.value = i === null || pale ? null : contacts[i]!.point)}
        />
      </div>
    </Section>
  ), [contacts, pale]);
}

/** What is left of rounding, a share of the drawing's size and a turn [degrees], of motions in the plane and in space. */
const NOTHING = { 2: 1e-12, 3: 1e-6 };
/** Beside the farthest motion, what is smaller than this share of it is nothing: four digits are shown. */
const DIGITS = 5e-5;
const NO_TURN = { 2: 1e-6, 3: 1e-4 };

/** How far every part goes in the answer, the farthest first. */
function Moved() {
  const path = answer.value?.paths[0];
  if (!path || path.n !== names.value.length || shown.value.what === "drag") return null;
  const motion = end(path);
  const width = columns(path);
  const axes = width === 7 ? 3 : 2;
  const most = Math.max(...names.value.map((_, i) => farOf(motion, i, width)));
  const nothing = Math.max(NOTHING[axes] * extent.value.radius, DIGITS * most);
  const rows = names.value.map((name, i): { far: number; cells: Cell[] } => {
    const turn = width === 7 ? turnOf(motion, i, width) : motion[3 * i + 2]!;
    const far = farOf(motion, i, width);
    const plain = (value: number, least: number): number => (Math.abs(value) < least ? 0 : value);
    const moves = [...motion.subarray(width * i, width * i + axes)].map((value) => plain(value, nothing));
    return { far, cells: [name, ...moves, plain((turn * 180) / Math.PI, NO_TURN[axes]), plain(far, nothing)] };
  });
  rows.sort((a, b) => b.far - a.far);
  return (
    <Section title="How far each part goes">
      <Table columns={["part", "dx mm", "dy mm", ...(axes === 3 ? ["dz mm"] : []), "turn °", "moved mm"]} rows={rows.map(({ cells }) => cells)} />
    </Section>
  );
}
