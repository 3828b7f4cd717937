/** The answer in one line over the canvas, and for screen readers as it changes. */

import { asks, design, goals, inSpace, pinned, pose } from "../design.ts";
import { factor, shown, suggested } from "../motion.ts";
import { answer, bound, standalone, busy, dragged, dragging, drawing, extent, line, modes, notice, running, selected, tab, unsure } from "../state.ts";
import { assembled } from "../sheetState.ts";
import { leavingStep } from "../leaving.ts";
import { cancel } from "../session.ts";
import type { FlexReply } from "../protocol.ts";
import { size } from "../stage/camera.ts";
import { mostMarks } from "../stage/marks.ts";
import { ask, few, inLine, number, short } from "../words.ts";
import { unitOf } from "./GapStrip.tsx";
import { Meaning } from "./Meaning.tsx";
import { Notices } from "./Notices.tsx";

export function Headline() {
  if (!drawing.value) return null;
  const { title, line, tone } = said();
  const settled = shown.value.what === "answer" && answer.value?.design === design.value && answer.value.reply.settled;
  const further = running.value.has("bound");
  return (
    <div class="headline">
      <div class="said">
        <p class={`answer ${tone}`} aria-live="polite" aria-atomic="true" id="answer" data-settled={settled} data-further={further} title={title}>
          {busy.value && <i class="busy" role="img" aria-label="working" />}{title}
        </p>
        <p class="facts" hidden={notice.value !== ""}>{line}{settled && <Meaning of={wordOf(answer.value!.reply)} />}</p>
        <Notices />
      </div>
      <Work />
    </div>
  );
}

const whole: Record<string, string> = { closer: "parts closer together", weight: "everything sinks in -z" };

/** How an answer is called: a verdict counts once the search from other starts has ended. */
const wordOf = ({ search, verdict }: FlexReply): string => ({ "to come": "found so far", "from rest": "found from rest", done: verdict })[search];

interface Said { title: string; line: string; tone: "" | "guess" | "warn" }

/** A shorter path than this share of the gap is none. */
const NOTHING = 2e-3;

function said(): Said {
  const onSheet = tab.value === "sheet" && !inSpace();
  const sheet = onSheet ? assembled.value : null;
  if (onSheet && !sheet) return { title: `${drawing.value!.parts.length} panels on the sheet`, line: "give the thickness of the material, then Assemble", tone: "" };
  if (sheet) return { title: sheet.headline, line: sheet.doubts[0] ?? "every flank meets another, and no other way to put the panels together does as well", tone: sheet.certainty === "sure" ? "" : "warn" };
  const { what, label } = shown.value;
  const about = answer.value;
  const told = standalone.value?.said;
  const { gap } = design.value;
  if (dragging.value && (what === "drag" || running.value.has("drag"))) return draggedSaid();
  if (what === "mode" && modes.value) {
    const mode = modes.value.reply.modes[modes.value.paths.indexOf(shown.value.frames!)];
    const far = mode ? (mode.ends === false ? "without end" : `up to ${number(mode.size, 3)} mm`) : "";
    return { title: `Wiggle, ${label}`, line: mode ? `${far} · most of all ${few(mode.parts, 4)}` : "", tone: "" };
  }
  const step = what === "escape" ? leavingStep() : null;
  if (step) {
    return told ? { title: told.title, line: `${label}: ${step.words}`, tone: "" } : { title: step.words, line: label, tone: "" };
  }
  if (what === "drag" && pose.value) {
    const moved = Object.keys(pose.value);
    return { title: `${moved.length === 1 ? inLine(moved[0]!) : `${moved.length} parts`} as left`, line: ["a drag begins here; the Home key brings all back to rest", ...enlarged()].join(" · "), tone: "" };
  }
  if (told) return { title: told.title, line: [...told.facts, ...enlarged()].join(" · "), tone: "" };
  if (!asks(design.value)) {
    const count = drawing.value!.parts.length;
    return { title: `${count} ${count === 1 ? "part" : "parts"}, nothing asked`, line: "drag a part to feel where it stops, or choose what is pulled", tone: "" };
  }
  const asked = goals.value.length ? few(goals.value.map(ask), 2) : whole[String(design.value.goals)] ?? "parts as far as they go";
  if (what === "between" || unsure.value || !about || about.design !== design.value) {
    if (!unsure.value) return { title: asked, line: line.value !== "open" ? "no answer while the server is away" : about ? "" : "no answer", tone: "guess" };
    const far = about?.design === design.value ? about.reply.objective : null;
    const least = far !== null && far > 0.01 * gap ? [`at least ${number(far, 3)} ${unitOf()} so far`] : [];
    return { title: asked, line: [`solving at gap ${number(gap)} mm`, ...least].join(" · "), tone: "guess" };
  }
  const { headline, facts } = about.reply;
  const most = about.reply.at_most === null && bound.value?.design === design.value ? bound.value.reply.words : "";
  const further = running.value.has("bound") ? ["looking further"] : [];
  return { title: headline, line: [...facts, ...(most ? [most] : []), ...enlarged(), ...thinned(about.reply.contacts.length), ...further].join(" · "), tone: about.reply.objective === null ? "warn" : "" };
}

/** What a dragged part does: while the hand leads nothing is claimed. */
function draggedSaid(): Said {
  const { part, grip } = dragging.value!;
  const name = short(part);
  const about = dragged.value;
  if (running.value.has("drag") || about?.reply.part !== part) return { title: `${name} follows the hand`, line: inSpace() ? "the outline is where the hand wants it" : "the dashed outline is where the hand wants it", tone: "guess" };
  const { reached, distance, blocking } = about.reply;
  const tiny = NOTHING * (design.value.gap || extent.value.radius / 500);
  const moved = Math.hypot(...reached.map((v, k) => v - grip[k]!));
  const away = distance > tiny ? `${number(distance, 3)} mm short of the pointer` : "at the pointer";
  const held = distance > tiny && blocking.length ? [`held by ${few(blocking)}`] : [];
  const pins = [...pinned.value].filter((one) => one !== part);
  return { title: `${name} moved ${moved > tiny ? number(moved, 3) : "0"} mm`, line: [...held, away, ...(pins.length ? [`pinned: ${few(pins, 3)}`] : []), ...enlarged()].join(" · "), tone: "" };
}

const enlarged = (): string[] => {
  if (factor() > 1) return [`motion drawn ×${factor()}: in the picture parts pass through each other, in truth they do not`];
  return suggested.value > 1 && !["rest", "between"].includes(shown.value.what) ? ["motion hardly seen at its true size"] : [];
};

/** That not all contacts have their arrow. */
function thinned(count: number): string[] {
  const most = mostMarks(size.value);
  return !inSpace() && count > most ? [`arrows at the ${most} strongest contacts in view`] : [];
}

const NAMES: Record<string, string> = {
  flex: "solving", check: "checking whether it comes apart", limit: "looking for the largest gap", plan: "planning how it is taken apart", sweep: "sweeping gaps", rank: "ranking gaps", prove: "proving a bound", tighten: "looking for parts to make tighter", sample: "trying gaps at random", gap: "looking for the gap to draw",
  assemble: "putting panels together", lay: "laying a panel", space: "free space", wiggle: "freedoms", reach: "how far it can be brought", save: "saving", open: "opening",
};

/** Long work under way: what it is, how far, and a way to end it. One line, however much waits: the picture stays where it is. */
function Work() {
  const rows = [...running.value].filter(([kind, told]) => NAMES[kind] && (told !== null || ["assemble", "lay", "check", "limit", "plan", "sweep", "rank", "prove", "save", "space", "wiggle", "reach", "tighten", "sample", "gap"].includes(kind)));
  const first = rows.find(([, told]) => told !== null) ?? rows[0];
  if (!first) return null;
  const [kind, told] = first;
  const waiting = rows.filter((one) => one !== first).map(([other]) => NAMES[other]!);
  const words = `${NAMES[kind]}${told?.objective ? `: ${number(told.objective)} so far` : ""}${told?.stage && kind !== told.stage ? `, ${told.stage}` : ""}`;
  return (
    <div class="work" key={kind} role="status">
      <progress aria-label={NAMES[kind]} value={told?.share ?? undefined} />
      <span title={words}>{words}</span>
      <button type="button" class="link" onClick={() => cancel(kind)}>cancel</button>
      {waiting.length > 0 && <span class="waiting" title={waiting.join(", ")}>{waiting.length} more {waiting.length === 1 ? "waits" : "wait"}</span>}
    </div>
  );
}

/** What is chosen, said to screen readers. */
export function Spoken() {
  const name = selected.value;
  const roles = name ? [design.value.fixed.includes(name) && "fixed", goals.value.some((goal) => goal.part === name) && "pulled"].filter(Boolean) : [];
  return <p class="unseen" aria-live="polite">{name ? `${name} chosen ${roles.join(", ")}` : ""}{factor() > 1 ? `, motion drawn ${factor()} times as far` : ""}</p>;
}
