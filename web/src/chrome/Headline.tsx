/** The answer in one line over the canvas, and for screen readers as it changes. */

import { asks, design, goals } from "../design.ts";
import { factor, shown, valueBetween } from "../motion.ts";
import { answer, baked, checked, dragged, drawing, modes, running, selected, solved, waiting } from "../state.ts";
import { cancel } from "../session.ts";
import type { Kind } from "../protocol.ts";
import { ask, few, number } from "../words.ts";
import { unitOf } from "./GapStrip.tsx";

export function Headline() {
  if (!drawing.value) return null;
  const { title, line, tone } = said();
  const settled = shown.value.what === "answer" && answer.value?.design === design.value && answer.value.reply.settled;
  return (
    <div class="headline">
      <p class={`answer ${tone}`} aria-live="polite" aria-atomic="true" id="answer" data-settled={settled}>{title}</p>
      <p class="facts">{line}</p>
      <Work />
    </div>
  );
}

interface Said { title: string; line: string; tone: "" | "guess" | "warn" }

function said(): Said {
  const { what, label } = shown.value;
  const about = answer.value;
  const told = baked.value?.said;
  if (what === "drag" && dragged.value) {
    const { part, reached, distance, blocking } = dragged.value.reply;
    const short = distance > 1e-9 ? `${number(distance, 3)} mm short of the pointer` : "at the pointer";
    return { title: `${part} dragged to (${number(reached[0])}, ${number(reached[1])})`, line: blocking.length ? `held by ${few(blocking)} · ${short}` : short, tone: "" };
  }
  if (what === "mode" && modes.value) {
    const mode = modes.value.reply.modes[modes.value.ways.indexOf(shown.value.frames!)];
    const far = mode ? (mode.ends === false ? "without end" : `up to ${number(mode.size, 3)} mm`) : "";
    return { title: `Wiggle, ${label}`, line: mode ? `${far} · most of all ${few(mode.parts, 4)}` : "", tone: "" };
  }
  if (what === "escape" && checked.value) {
    const step = checked.value.reply.escapes[checked.value.ways.indexOf(shown.value.frames!)];
    return told ? { title: told.title, line: `${label}: ${step?.words}`, tone: "" } : { title: step?.words ?? "The way out", line: label, tone: "" };
  }
  if (told) return { title: told.title, line: [...told.facts, ...enlarged()].join(" · "), tone: "" };
  if (!asks(design.value)) {
    const count = drawing.value!.parts.length;
    return { title: `${count} ${count === 1 ? "part" : "parts"}, nothing asked`, line: "choose a part and press P to pull it, or drag it", tone: "" };
  }
  if (what === "between") {
    const guess = valueBetween(solved.value, design.value.gap);
    return { title: guess === null ? "…" : `about ${number(guess, 3)} ${unitOf()}`, line: "between solved gaps, solving", tone: "guess" };
  }
  if (!about) return { title: goals.value.map(ask).slice(0, 2).join(", "), line: waiting.value ? "solving" : "no answer", tone: "guess" };
  const { headline, facts, settled } = about.reply;
  const line = [...(settled ? facts : ["settling", ...facts.slice(1)]), ...enlarged()].join(" · ");
  return { title: headline, line, tone: about.reply.objective === null ? "warn" : about.design === design.value ? "" : "guess" };
}

const enlarged = (): string[] => (factor() > 1 ? [`motion shown ×${factor()}`] : []);

const NAMES: Record<string, string> = {
  flex: "solving", check: "checking whether it comes apart", sweep: "sweeping gaps", rank: "ranking gaps", prove: "proving a bound",
  space: "free space", wiggle: "freedoms", save: "saving", open: "opening",
};

/** Long work under way: what it is, how far, and a way to end it. */
function Work() {
  const rows = [...running.value].filter(([kind, told]) => NAMES[kind] && (told !== null || ["check", "sweep", "rank", "prove", "save", "space", "wiggle"].includes(kind)));
  return (
    <>
      {rows.map(([kind, told]) => (
        <div class="work" key={kind} role="status">
          <progress aria-label={NAMES[kind]} value={told?.share ?? undefined} />
          <span>{NAMES[kind]}{told?.objective != null ? `: ${number(told.objective)} so far` : ""}{told?.stage && kind !== told.stage ? `, ${told.stage}` : ""}</span>
          <button type="button" class="link" onClick={() => cancel(kind as Kind)}>cancel</button>
        </div>
      ))}
    </>
  );
}

/** What is chosen, said to screen readers. */
export function Spoken() {
  const name = selected.value;
  const roles = name ? [design.value.fixed.includes(name) && "fixed", goals.value.some((goal) => goal.part === name) && "pulled"].filter(Boolean) : [];
  return <p class="unseen" aria-live="polite">{name ? `${name} chosen ${roles.join(", ")}` : ""}{factor() > 1 ? `, motion shown ${factor()} times` : ""}</p>;
}
