/** What is asked, what was found, and what holds it. */

import { design, goals, removeGoal, setGoal, toggleFixed, unglue } from "../design.ts";
import { type Goal, isPull, isTurn, type Point } from "../protocol.ts";
import { answer, baked, dragged, highlit, selected } from "../state.ts";
import { shown } from "../motion.ts";
import { degrees, few, number, short } from "../words.ts";
import { Button } from "../chrome/Button.tsx";
import { NumberBox } from "../chrome/NumberBox.tsx";
import { copy } from "../chrome/SaveMenu.tsx";
import { Section } from "./Section.tsx";

const MOST = 12;

export function Answer() {
  const about = answer.value;
  return (
    <>
      <Asked />
      <Standing />
      {about && (
        <>
          {about.reply.leaves.length > 0 && <Section title="Leaves"><p>{few(about.reply.leaves, 12)}</p></Section>}
          <Held />
          {about.reply.command && (
            <Section title="The same in a terminal" side={<Button icon="copy" label="Copy the command" onClick={() => copy(about.reply.command)} />}>
              <pre class="command" tabIndex={0}>{about.reply.command}</pre>
            </Section>
          )}
        </>
      )}
    </>
  );
}

function Asked() {
  const whole = design.value.goals;
  return (
    <Section title="Asked">
      {typeof whole === "string" && <p>{whole === "closer" ? "neighbours closer" : "sum of squared translations"}</p>}
      {typeof whole !== "string" && goals.value.length === 0 && <p class="quiet">Nothing yet. Choose a part, then P pulls it.</p>}
      <ul class="rows">{goals.value.map((goal, i) => <GoalRow key={i} goal={goal} index={i} />)}</ul>
    </Section>
  );
}

function GoalRow({ goal, index }: { goal: Goal; index: number }) {
  const still = baked.value;
  const turned = (angle: number): Point => [Math.cos((angle * Math.PI) / 180), Math.sin((angle * Math.PI) / 180)].map((v) => Number(v.toFixed(6)) + 0) as Point;
  return (
    <li class="row">
      <button type="button" class="link name" onClick={() => (selected.value = goal.part)}>{short(goal.part)}</button>
      {!still && !isPull(goal) && !isTurn(goal) ? <span class="grow">w = ({goal.w.map((v) => number(v, 3)).join(", ")})</span> : (
        <select
          aria-label={`what is asked of ${goal.part}`} disabled={still} value={isPull(goal) ? "pull" : isTurn(goal) ? goal.turn : "w"}
          onChange={(event) => {
            const to = event.currentTarget.value;
            setGoal(index, to === "pull" ? { part: goal.part, direction: [1, 0] } : { part: goal.part, turn: to as "cw" | "ccw" });
          }}
        >
          <option value="pull">pull</option><option value="ccw">turn ccw</option><option value="cw">turn cw</option>
        </select>
      )}
      {isPull(goal) && (
        <NumberBox
          value={Number(degrees(goal.direction).toFixed(3))} digits={5} step={5} unit="°" label={`direction of the pull on ${goal.part}`} disabled={still}
          onChange={(angle) => setGoal(index, { ...goal, direction: turned(angle) })}
        />
      )}
      {!still && <Button icon="close" label={`Do not ask for ${goal.part}`} onClick={() => removeGoal(index)} class="small" />}
    </li>
  );
}

function Standing() {
  const { fixed, glue } = design.value;
  return (
    <Section title="Fixed">
      {fixed.length === 0 && <p class="quiet">Nothing is fixed. Choose a part, then F fixes it.</p>}
      <ul class="chips">
        {fixed.slice(0, 40).map((name) => <Chip key={name} class="fixed" name={name} onRemove={() => toggleFixed(name)} words={`let ${name} go`} />)}
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
      {!baked.value && <button type="button" aria-label={words} title={words} onClick={onRemove}>×</button>}
    </li>
  );
}

function Held() {
  const contacts = (shown.value.what === "drag" ? dragged.value?.reply.held : answer.value?.reply.contacts)?.filter((one) => one.force > 0) ?? [];
  if (contacts.length === 0) return null;
  const most = Math.max(...contacts.map((one) => one.force));
  const rows = [...contacts].sort((a, b) => b.force - a.force).slice(0, MOST);
  return (
    <Section title="What holds it" side={<span class="quiet">{contacts.length} {contacts.length === 1 ? "contact" : "contacts"}</span>}>
      <table class="contacts">
        <thead><tr><th scope="col">between</th><th scope="col">force</th></tr></thead>
        <tbody>
          {rows.map((one, i) => (
            <tr key={i} onPointerEnter={() => (highlit.value = one.point)} onPointerLeave={() => (highlit.value = null)}>
              <td>{one.parts.map((name, k) => <>{k > 0 && " | "}<button type="button" class="link" onClick={() => (selected.value = name)}>{short(name, 14)}</button></>)}</td>
              <td class="bar"><meter min={0} max={most} value={one.force} aria-label="force" /><span>{number(one.force, 3)}</span></td>
            </tr>
          ))}
        </tbody>
      </table>
      {contacts.length > MOST && <p class="quiet">and {contacts.length - MOST} weaker</p>}
    </Section>
  );
}
