/** Between the design and the server: asks when the design changes, keeps the answers, shows them. */

import { batch, effect, untracked } from "@preact/signals";
import { asks, begin, change, correctPose, design, dimension, goals, history, inSpace, leave, list, pinned, type Pose, pose, question, questionOf, type Step, toggleFixed } from "./design.ts";
import { between, chosenFactor, end, motionOf, play, poseOf, shareWithin, show, showAnswer, shown, showRest } from "./motion.ts";
import { type CheckReply, type Design, type Fault, type Frames, type Kind, type Opened, type PlanReply, type Point, type HowRead, type Made, type Reply, type Solids, type Triple, type Requests, type SaveWhat, toBase64 } from "./protocol.ts";
import { fitsParts, flush, forgetFile, isLink, keepDesign, keepFile, keepReading, keepRecent, keepServed, keptDesign, keptReading, keptFile, keptServed, leaveLink, linked, recent, linkTo, mark, type Opening, token } from "./keep.ts";
import { download } from "./save.ts";
import { type Kept, kept, linked as linkedViews, ofThisFile, presentAnswer } from "./stage/kept.ts";
import { lead, origin } from "./stage/lead.ts";
import { leavingAbout } from "./leaving.ts";
import { followed, magnify, reachOf } from "./magnify.ts";
import { type Line, nameOf, requestOf, Socket } from "./socket.ts";
import { assembled, forgetSheet, laid, ofSheet } from "./sheetState.ts";
import * as state from "./state.ts";

let socket: Socket | null = null;
const asked = new Map<number, { kind: string; design: Design }>();
/** Of a reply whose request is not known: never the present one. */
const UNKNOWN: Design = { gap: 0, extra: {}, fixed: [], glue: [], goals: [] };
let quick: { id: number; since: number; again: boolean } | null = null;
/** The newest request of the drag under way; what was answered to the ones before it is shown too. */
let drag: { id: number; wanted: Wanted } | null = null;
type Wanted = Requests["drag"];
/** Name of the outlines that are shown. */
let outlines = "";

/** A request under way this long gives way to a newer one; before, the newer one waits for its answer. */
const PATIENCE = 600;

export function start(): void {
  const url = new URL("socket", location.href);
  url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
  url.search = `?token=${encodeURIComponent(token())}`;
  state.served.value = keptServed();
  socket = new Socket(url.href, { reply: hear, line: heardLine });
  addEventListener("hashchange", () => isLink() && location.reload()); // a link that was put into this tab's address
  follow();
}

/** Whenever the design changes: keep it, show what is likely, ask for the truth. */
export function follow(): void {
  let before = "";
  effect(() => {
    const now = design.value;
    const opened = state.drawing.peek();
    if (!opened) return;
    if (question.value !== before) {
      before = question.value;
      if (state.running.peek().has("sweep")) cancel("sweep"); // of another question
      batch(() => {
        state.solved.value = [];
        state.lost.value = null;
      });
    }
    untracked(() => {
      if (reviewed) state.findings.value = state.findings.peek().filter((one) => !changed(one.about, reviewed!, now));
      else if (state.trouble.peek() !== "line" && !ofSheet(state.trouble.peek())) state.findings.value = []; // of a question about the design before
      reviewed = now;
      preview(now.gap);
      askFlex();
    });
  });
  effect(() => {
    const opened = state.drawing.value;
    const [now, left] = [design.value, pose.value];
    if (opened) untracked(() => keepDesign(opened, now, left, history()));
  });
  let last: { left: Pose | null; of: Design | null } = { left: null, of: null };
  effect(() => {
    const left = pose.value;
    if (left === last.left) return;
    const other = last.of !== design.peek();
    last = { left, of: design.peek() };
    if (!state.drawing.peek() || (left && left === leaving)) return;
    if (left) untracked(() => showPose(left));
    else if (!other) untracked(back); // of another design the answer comes
  });
}

/** The pose that is shown already, as the drag that led there. */
let leaving: Pose | null = null;

/** Shows where parts were left, and asks whether they may be there: another gap may have been set, or the file changed. */
function showPose(left: Pose): void {
  endDrag();
  const n = state.names.peek().length;
  show({ what: "drag", frames: { k: 1, n, data: motionOf(left, state.names.peek(), inSpace() ? 7 : 3) }, label: "as left", back: false }, true);
  ask("pose", { design: design.peek(), pose: left as Requests["pose"]["pose"] });
}

/** What was told of a pose: where parts overlap there, they are brought back. */
function posed(about: state.About<Extract<Reply, { kind: "pose" }>>): void {
  if (about.design !== design.peek() || about.reply.free || !pose.peek()) return;
  endDrag();
  correctPose(null);
  state.notice.value = about.reply.words;
}

/** What is known of the drag under way: the number of its first request, where it has led, whether it has its step of undo, whether
 * the hand holds the part still, and the pose with which it began. */
const drags = { since: 0, at: null as Frames | null, kept: false, held: false, begun: null as Pose | null, timer: 0 };
/** So long after the last motion [ms] the judge is asked whether parts may be left there. */
const LEFT = 120;

/** The parts stay where a drag has brought them: one step of undo for each time that the hand took a part. */
function leaveThere(): void {
  if (!drags.at) return;
  leaving = poseOf(end(drags.at), state.names.peek(), inSpace() ? 7 : 3);
  if (drags.kept) correctPose(leaving);
  else leave(leaving);
  drags.kept = true;
  clearTimeout(drags.timer);
  drags.timer = window.setTimeout(() => leaving && pose.peek() === leaving && ask("pose", { design: design.peek(), pose: leaving as Requests["pose"]["pose"] }), LEFT);
}

/** The hand lets the part go: it stays there. */
export function release(): void {
  drags.held = false;
  leaveThere();
}

/** Brings all parts back to where they are drawn. */
export function backToRest(): void {
  endDrag();
  leave(null);
  showRest();
}

/** The design that the findings are about; null where they are about something else. */
let reviewed: Design | null = null;

/** What findings of a kind depend on. */
const DEPENDS: Record<Fault["about"], (keyof Design)[]> = { stands: ["fixed"], pulled: ["goals"], gap: ["gap", "extra", "gaps", "glue"], parts: ["gap", "extra", "gaps"] };
const changed = (about: Fault["about"], before: Design, now: Design): boolean => DEPENDS[about].some((key) => before[key] !== now[key]);

function preview(gap: number): void {
  const opened = state.drawing.peek()!;
  if (pose.peek()) return;
  const guess = asks(design.peek()) ? between(state.solved.peek(), gap, inSpace() ? 7 : 3) : null;
  if (guess) show({ what: "between", frames: { k: 1, n: opened.parts.length, data: guess }, label: "between solved gaps", back: false }, false);
  else if (["between", "mode", "escape"].includes(shown.peek().what)) showRest(false); // of another design
}

const NO_SERVER = "The server does not answer. If it has ended, start wiggleroom serve again and open the address that it prints; what you set is kept.";

/** Says that nothing can be asked now. */
function away(): void {
  state.trouble.value = "line";
  state.findings.value = [said(NO_SERVER)];
  state.sheetOpen.value = true;
}

/** Sends a request and gives its number; 0 while there is no line. */
export function ask<K extends Kind>(kind: K, body: Requests[K], goesOn = false): number {
  const id = socket?.ask(kind, body, goesOn) ?? 0;
  if (!id) {
    if (socket && kind !== "bound") away(); // a bound is asked by the page itself
    return 0;
  }
  const name = nameOf(kind, body);
  if ("design" in body) asked.set(id, { kind: name, design: body.design as Design });
  for (const [old, one] of asked) if (one.kind === name && old < id - 500) asked.delete(old); // a moving hand asks hundreds of times while a study goes on
  setRunning(name, true);
  return id;
}

/** Asks a question that the server declares. */
export function askStudy(of: string, options: Record<string, number | boolean>): void {
  ask("study", { design: design.peek(), of, options });
}

function setRunning(kind: string, on: boolean): void {
  const before = state.running.peek();
  if (on ? before.get(kind) === null : !before.has(kind)) return; // a moving hand asks at every frame
  const now = new Map(before);
  if (on) now.set(kind, null);
  else now.delete(kind);
  state.running.value = now;
}

export function cancel(kind: string): void {
  socket?.cancel(kind);
  setRunning(kind, false);
  if (kind === "flex") quick = null;
  if (kind === "open") state.opening.value = "";
}

/** Asks for the largest motion, or only for the outlines where nothing is asked. */
function askFlex(): void {
  const wanted = design.peek();
  endDrag();
  setRunning("bound", false); // the server leaves it too
  const asking = asks(wanted);
  const other = asking ? "shape" : "flex";
  if (state.running.peek().has(other)) cancel(other); // what it would tell is of a design before
  if (!asking) {
    state.answer.value = null;
    if (!pose.peek()) showRest();
    ask("shape", { design: wanted });
    return;
  }
  if (quick && performance.now() - quick.since < PATIENCE) {
    quick.again = true;
    return;
  }
  const id = ask("flex", { design: wanted, thorough: false, shown: outlines });
  state.waiting.value = id > 0;
  quick = id ? { id, since: performance.now(), again: false } : null;
}

/** Asks the server to bring a point of a part, given at rest, as near as it can to a target. */
export function askDrag(part: string, grip: Point | Triple, target: Point | Triple, pointing = true): void {
  if (!socket?.ready) return away();
  state.notice.value = "";
  const goesOn = drag !== null && drag.wanted.part === part && drag.wanted.design === design.peek() && same(drag.wanted.grip, grip);
  if (!goesOn) Object.assign(drags, { since: Infinity, at: null, kept: false, begun: origin() === "pose" ? pose.peek() : null });
  drags.held = pointing;
  const held = [...pinned.peek()].filter((name) => state.indexOf.peek().has(name) && name !== part);
  const answered = goesOn && drags.at !== null && shown.peek().what === "drag";
  const { begun } = drags;
  const said = begun && (!answered || Object.keys(begun).length <= MAX_SAID) ? { pose: begun as Wanted["pose"] } : {};
  const wanted: Wanted = { design: design.peek(), part, grip, target, from: answered ? "here" : origin(), pinned: held, shown: outlines, ...said };
  leads(wanted, state.shapedNow.peek());
  const before = state.dragging.peek();
  if (before?.part !== part || before.grip !== grip) state.dragging.value = { part, grip };
  const id = ask("drag", wanted, goesOn); // at once: the server begins with it as soon as the one before is answered
  drag = id ? { id, wanted } : null;
  if (id && drags.since === Infinity) drags.since = id;
}

/** A pose of more parts than these is said once, at the beginning of a drag. */
const MAX_SAID = 200;
const same = (a: readonly number[], b: readonly number[]): boolean => a.length === b.length && a.every((v, k) => v === b[k]);

/** In the plane the part follows the hand at once; in space its ghost does, until the answer comes. */
function leads({ part, grip, target }: Wanted, shaped: boolean): void {
  const free = origin() !== "rest" || shown.peek().what === "rest";
  if (!inSpace()) lead.value = { part, grip: grip as Point, target: target as Point, shaped: shaped && free };
}

/** Fixes a part or lets it go; what is asked of it is left out then, and that is said. */
export function fixOrNot(part: string): void {
  const asked = goals.peek().some((goal) => goal.part === part);
  toggleFixed(part);
  if (asked && design.peek().fixed.includes(part)) state.notice.value = `${part} is fixed now, and no longer pulled; Ctrl-Z takes that back`;
}

/** Whether a part can move at all; says so where it cannot. */
function movable(part: string): boolean {
  const stands = design.peek().fixed.includes(part);
  if (stands) state.notice.value = `${part} is fixed: it does not move`;
  return !stands;
}

/** Asks for every freedom that is left, of one part or of all. */
export function askModes(part?: string): void {
  if (!part || movable(part)) ask("wiggle", { design: design.peek(), ...(part && { part }) });
}

/** Asks where the chosen part can be brought by the point where it was pressed. */
export function askReach(part: string): void {
  if (!movable(part)) return;
  const i = state.indexOf.peek().get(part)!;
  const grip = state.pressed.peek() ?? (state.drawing.peek()!.parts[i]!.at.slice(0, 2) as Point);
  ask("reach", { design: design.peek(), part, grip });
}

function endDrag(): void {
  if (drag && state.running.peek().has("drag")) cancel("drag");
  drag = null;
  drags.at = null;
  clearTimeout(drags.timer);
  lead.value = null;
  state.dragged.value = state.dragging.value = null;
}

/** Back to the answer, or to rest where nothing is asked. */
export function back(): void {
  endDrag();
  if (pose.peek()) return leave(null); // which leads here once more
  const known = state.answer.peek();
  if (known?.paths[0]) showAnswer(known.paths[0], known.reply.leaves.length > 0, followed());
  else showRest();
}

/** Opens a file that was chosen or dropped; a folder cannot be read. */
export async function openPicked(file: File): Promise<void> {
  state.opening.value = file.name;
  const bytes = await file.arrayBuffer().catch(() => null);
  if (bytes) return openFile(file.name, new Uint8Array(bytes));
  state.opening.value = "";
  state.unopened.value = [`${file.name}: cannot be read; choose one file, not a folder`];
  state.sheetOpen.value = true;
}

function openFile(name: string, bytes: Uint8Array): void {
  const most = state.hello.peek()?.limits.upload_mb ?? 20;
  if (bytes.length > most * 1e6) {
    state.opening.value = "";
    state.unopened.value = [`${name}: ${(bytes.length / 1e6).toFixed(1)} MB, at most ${most} MB can be opened here`];
    state.sheetOpen.value = true;
    return;
  }
  openAs({ name, data: toBase64(bytes) });
}

function requestFor(what: Opening): Requests["open"] {
  if (!("data" in what)) return what;
  const { reading, ...rest } = what;
  return { ...rest, ...reading };
}

/** Reads the file that is open in another way. */
export function readAgain(reading: HowRead): void {
  sameQuestion = true;
  const file = state.file.peek();
  if (file && "data" in file) return openAs({ name: file.name, data: file.data, reading });
  keepReading(state.drawing.peek()!.name, reading);
  state.opening.value = state.drawing.peek()!.name;
  if (!ask("open", { name: state.drawing.peek()!.name, again: true, ...reading })) state.opening.value = "";
}
/** Whether what was set stays in the next drawing, which is this one in another way. */
let sameQuestion = false;

/** Makes blocks with joints; what is set stays, where their parts are there. */
export function make(made: Made): void {
  sameQuestion = state.drawing.peek()?.made !== undefined && !state.atStart.peek();
  openAs({ name: `${made.pattern}.json`, make: made });
}

/** Sets everything as the file says it. */
export function asRead(): void {
  if (asInFile) change(asInFile);
}
let asInFile: Design | null = null;

/** Opens a file that was read before, or a sample. */
export function openAs(what: Opening): void {
  state.opening.value = what.name;
  state.unopened.value = [];
  pendingFile = what;
  if (!ask("open", requestFor(what))) state.opening.value = "";
}
let pendingFile: Opening | null = null;
/** Whether the next drawing is the one that is open already. */
let again = false;

/** Keeps the present answer beside. */
export function keepBeside(): void {
  const present = presentAnswer();
  if (!present) return;
  [linkedViews.value, kept.value] = [true, present];
  state.notice.value = "Kept beside: change something, or open another file";
}

/** Goes to the design that is kept, in its file, and keeps the present one in its place. */
export function swapKept(): void {
  const before = kept.peek();
  if (!before) return;
  const present = presentAnswer() ?? before;
  if (ofThisFile.peek()) {
    kept.value = present;
    return change(before.about.design);
  }
  returning = { to: before.about.design, keeps: present };
  openAs(before.file ?? { name: before.opened.name, served: true });
}
/** The design with which the next drawing is opened, and what is kept beside it then. */
let returning: { to: Design; keeps: Kept } | null = null;

/** Saves the answer to the present design, or the film that is shown, whichever design that is of. */
export function save(what: SaveWhat, kerf = 0): void {
  const film = leavingAbout();
  ask("save", { design: film?.design ?? design.peek(), what, of: film?.reply.kind ?? "flex", ...(kerf > 0 && { kerf }) });
}

/** The address that leads to this design. */
export function link(): string {
  const file = state.file.peek();
  return linkTo(state.drawing.peek()!, design.peek(), file && "sample" in file ? file.name : undefined);
}

function heardLine(now: Line): void {
  state.line.value = now;
  if (now === "open") {
    quick = null;
    drag = null;
    if (state.trouble.value === "line") state.findings.value = [];
    return;
  }
  state.running.value = new Map();
  state.waiting.value = false;
  state.opening.value = "";
  drag = null;
  lead.value = null;
  if (shown.peek().what !== "drag") state.dragging.value = null;
}

function hear(reply: Reply, paths: Frames[]): void {
  batch(() => take(reply, paths));
}

function take(reply: Reply, paths: Frames[]): void {
  if (reply.kind === "progress") {
    if (!state.running.peek().has(reply.kind_of)) return;
    state.running.value = new Map(state.running.peek()).set(reply.kind_of, reply);
    return;
  }
  const settled = !("settled" in reply) || reply.settled;
  const earlier = reply.kind === "drag" && reply.id !== drag?.id; // than where the hand is now
  const beside = reply.kind === "flex" && isBeside(reply.id);
  if ("id" in reply && settled && reply.kind !== "step" && !earlier && !beside) setRunning(requestOf(reply), false);
  const about = <T>(of: T) => ({ reply: of, design: asked.get((of as { id: number }).id)?.design ?? UNKNOWN, paths });
  const still = (of: Reply): boolean => state.current(about(of)); // the design is still the one that was asked about
  switch (reply.kind) {
    case "hello": state.hello.value = reply; return reopen();
    case "worker": return worker(reply.state);
    case "opened": return opened(reply);
    case "shape": return still(reply) ? restShaped(reply) : undefined;
    case "flex": return flexed(about(reply), beside);
    case "drag": return draggedTo(about(reply));
    case "modes": state.modes.value = about(reply); return still(reply) ? showMode(0) : undefined;
    case "pose": return posed(about(reply));
    case "reach": state.reach.value = about(reply); return;
    case "rank": state.ranking.value = about(reply); state.coloured.value = true; return;
    case "check": state.checked.value = about(reply); return still(reply) ? showEscape(0) : undefined;
    case "limit": state.limit.value = about(reply); return;
    case "plan": state.planned.value = about(reply); return still(reply) ? showEscape(0, state.planned.peek()) : undefined;
    case "step": if (questionOf(about(reply).design) === question.peek()) stepped(reply.gap, reply.objective, reply.verdict, paths[0]); return;
    case "sweep": if (questionOf(about(reply).design) === question.peek()) state.lost.value = reply.lost; return;
    case "space": state.space.value = about(reply); return;
    case "study": state.studies.value = { ...state.studies.peek(), [reply.of]: about(reply) }; if (Object.keys(reply.tints.values).length) [state.tinted.value, state.coloured.value] = [reply.of, true]; return;
    case "prove": return proved(about(reply));
    case "bound": return bounded(about(reply));
    case "assembled": assembled.value = reply; if (ofSheet(state.trouble.value)) state.findings.value = []; return;
    case "lay": laid.value = reply; return;
    case "saved": return download(reply);
    case "failed": return failed(reply.of, reply.review ?? reply.findings.map(said), asked.get(reply.id)?.design);
  }
}

/** Takes what parts look like, where a reply says it. */
function reshaped({ rings, solids, shown }: { rings?: Opened["parts"][number]["rings"][]; solids?: Solids; shown?: string }): void {
  if (shown && shown === outlines) return; // the full answer tells them again
  outlines = shown ?? outlines;
  if (solids) state.solids.value = solids;
  else if (rings) state.rings.value = rings;
}

/** Outlines of the present design, of which nothing is asked. */
function restShaped(reply: Extract<Reply, { kind: "shape" }>): void {
  reshaped(reply);
  state.shaped.value = design.peek();
  state.findings.value = [];
}

/** Whether an answer was told by a search in idle time, or before a study. */
const isBeside = (id: number): boolean => (asked.get(id)?.kind ?? "flex") !== "flex";

function flexed(about: state.About<Extract<Reply, { kind: "flex" }>>, beside: boolean): void {
  const { reply, paths } = about;
  const again = quick?.id === reply.id && quick.again;
  if (quick?.id === reply.id) quick = null;
  if (beside && about.design !== design.peek()) return;
  reshaped(reply);
  state.shaped.value = about.design;
  const same = questionOf(about.design) === question.peek();
  if (same && paths[0] && reply.settled) remember({ gap: about.design.gap, objective: reply.objective, verdict: reply.verdict, end: end(paths[0]), atMost: reply.at_most });
  if (about.design === design.peek()) {
    state.waiting.value = false;
    const before = state.answer.peek()?.reply.objective;
    const more = reply.objective === null || before == null || reply.objective > before * (1 + 1e-6);
    state.answer.value = about;
    if (beside && !more) return; // the same motion, and that nothing better was found
    if (beside) state.notice.value = `a larger motion was found: ${reply.headline}`;
    else if (reply.settled && reply.objective && (reply.at_most === null || reply.search === "to come") && !inSpace()) ask("bound", { design: about.design });
    if (state.trouble.value === "flex") state.findings.value = [];
    const elsewhere = pose.peek() || (beside && shown.peek().what !== "answer"); // a film is seen, or a dragged part
    if (paths[0] && !elsewhere && (shown.peek().what !== "drag" || !state.dragged.peek())) {
      magnify(reachOf(paths[0]));
      const still = shown.peek().what === "answer" && !reply.leaves.length;
      showAnswer(paths[0], reply.leaves.length > 0, followed(), still || shown.peek().what !== "answer");
    }
  }
  if (again) askFlex();
}

function remember(one: state.Solved): void {
  const others = state.solved.peek().filter((other) => Math.abs(other.gap - one.gap) > 1e-9);
  state.solved.value = [...others, { ...one, end: one.objective === null ? null : one.end }].sort((a, b) => a.gap - b.gap);
}

function stepped(gap: number, objective: number | null, verdict: string, path?: Frames): void {
  const known = state.solved.peek().find((one) => Math.abs(one.gap - gap) < 1e-9);
  if (objective !== null && known?.objective != null && known.objective >= objective) return; // of two motions the larger counts
  remember({ gap, objective, verdict, end: path ? end(path) : null });
}

/** A proof counts for the gap that it is about. */
function proved(about: state.About<Extract<Reply, { kind: "prove" }>>): void {
  state.proof.value = about;
  const known = state.solved.peek().find((one) => Math.abs(one.gap - about.design.gap) < 1e-9);
  if (known && questionOf(about.design) === question.peek()) remember({ ...known, atMost: about.reply.at_most });
}

/** What stands beside the answer, as long as it is the answer of this design. */
function bounded(about: state.About<Extract<Reply, { kind: "bound" }>>): void {
  if (about.design !== design.peek()) return;
  state.bound.value = about;
  const known = state.solved.peek().find((one) => Math.abs(one.gap - about.design.gap) < 1e-9);
  if (known && known.atMost == null && about.reply.at_most !== null) remember({ ...known, atMost: about.reply.at_most });
}

function draggedTo(about: state.About<Extract<Reply, { kind: "drag" }>>): void {
  if (!drag || about.reply.id < drags.since) return; // of a part that was let go since
  reshaped(about.reply);
  state.shaped.value = about.design;
  if (about.design !== design.peek() || !about.paths[0]) return;
  const before = state.dragged.peek()?.reply;
  if (!about.reply.settled && before?.part === about.reply.part) about.reply.blocking = before.blocking; // until it is known anew
  state.dragged.value = about;
  const others = state.dragged.peek() !== null && shown.peek().what === "drag" && before?.id === about.reply.id && before.settled;
  show({ what: "drag", frames: about.paths[0], label: "dragged", back: false }, others); // the others go back softly
  drags.at = about.paths[0];
  if (!drags.held) leaveThere();
  if (about.reply.settled && about.reply.id === drag.id) lead.value = null; // the truth is there
  else leads(drag.wanted, state.shapedNow.peek());
}

export function showMode(which: number): void {
  const known = state.modes.peek();
  const frames = known?.paths[which];
  if (!frames) return;
  magnify(Math.max(known.reply.modes[which]!.size, 0));
  show({ what: "mode", frames, label: `freedom ${which + 1} of ${known.paths.length}`, back: false });
  play(true);
}

/** Play one path out of a check, or one step of a plan. */
export function showEscape(which: number, about: state.About<CheckReply | PlanReply> | null = state.checked.peek()): void {
  const frames = about?.paths[which];
  if (!frames) return;
  const count = about.paths.length;
  const next = count > 1 ? () => showEscape((which + 1) % count, about) : undefined; // one after the other
  const earlier = state.standalone.peek() || state.current(about) ? "" : " of an earlier design";
  const name = (about.reply.kind === "plan" ? "plan" : "path out") + earlier;
  show({ what: "escape", frames, label: count > 1 ? `${name}, step ${which + 1} of ${count}` : name, back: false, next, until: shareWithin(frames, followed()) }, false);
  play(true);
}

/** What a drawing's parts are: its file may have changed while the line was down. */
const looks = ({ parts, solids }: Opened): string => JSON.stringify([parts, solids]);

function opened(reply: Opened): void {
  state.opening.value = "";
  if (reply.id === 0) keepServed((state.served.value = reply.name));
  if (reply.id === 0 && state.file.peek()) return; // a reload: the file that was dropped here comes after
  const otherwise = reply.id === 0 ? keptReading(reply.name) : null;
  if (reply.id !== 0 && pendingFile) {
    const file = (state.file.value = "served" in pendingFile ? null : pendingFile);
    if (file) keepFile(file);
    else forgetFile();
    if (file && "data" in file) keepRecent(file);
    pendingFile = null;
  }
  flush();
  const before = state.drawing.peek();
  if (before && again && mark(before) === mark(reply) && looks(before) === looks(reply)) {
    again = false;
    return askFlex(); // the line came back: nothing that was set is lost
  }
  again = false;
  endDrag();
  quick = null;
  state.running.value = new Map(); // the server has left what was asked of the drawing before
  state.waiting.value = false;
  const read: Design = { ...reply.design, gap: reply.gap };
  const suggested = reply.pulled ? [reply.pulled].flat() : [];
  const chosen = state.selected.peek();
  if (!asks(read) && !reply.apart) read.goals = suggested; // panels of a sheet are put together first
  const known = reply.id === 0 && before?.name === reply.name && asInFile ? merged(design.peek(), asInFile, read) : null; // it has changed on disk
  state.atStart.value = false;
  state.findings.value = [];
  state.unopened.value = [];
  state.pointed.value = null;
  for (const one of [state.answer, state.dragged, state.modes, state.ranking, state.checked, state.limit, state.planned, state.space, state.proof, state.bound, state.reach]) one.value = null;
  state.studies.value = {};
  forgetSheet();
  if (state.tab.peek() === "sheet" && !reply.apart) state.tab.value = "answer";
  state.selected.value = null;
  state.many.value = new Set();
  state.solved.value = [];
  dimension.value = reply.dimension;
  state.rings.value = reply.parts.map((part) => part.rings);
  state.solids.value = reply.solids ?? null;
  state.outlined.value = new Set();
  state.exploded.value = 0;
  state.section.value = null;
  state.shaped.value = null;
  outlines = "";
  state.drawing.value = reply;
  chosenFactor.value = 1;
  showRest(false);
  asInFile = read;
  const stays = sameQuestion && fitsParts(design.peek(), reply);
  sameQuestion = false;
  const mine = stays || known ? null : keptDesign(reply, !state.file.peek());
  leaving = null;
  if (known) begin(...goneOn(known, read, reply));
  else if (stays) begin(...goneOn({ ...design.peek() }, read, reply)); // a new object: it is asked anew
  else begin(mine?.design ?? read, mine?.history, mine?.pose ?? null);
  if (kept.peek() && !ofThisFile.peek()) linkedViews.value = false;
  if (returning) {
    kept.value = returning.keeps;
    if (JSON.stringify(returning.to) !== JSON.stringify(design.peek())) change(returning.to);
    returning = null;
  }
  if (known && chosen && state.indexOf.peek().has(chosen)) state.selected.value = chosen;
  const count = reply.notes.length;
  if (count) state.notice.value = `${count === 1 ? "One note" : `${count} notes`} on how the file was read, in the tab Answer`;
  if (known) state.notice.value = `${reply.name} has changed on disk and was read again`;
  else if (mine?.from === "browser") state.notice.value = "What you set for this file before is here again; “As the file says”, in the tab Answer, begins anew";
  leftOut(reply.name);
  if (otherwise) readAgain(otherwise);
}

/** What is set for a file that has changed: what the user changed stays, and all else is as the file says now. */
function merged(set: Design, before: Design, now: Design): Design {
  const own = (Object.keys(set) as (keyof Design)[]).filter((key) => JSON.stringify(set[key]) !== JSON.stringify(before[key]));
  return { ...now, ...Object.fromEntries(own.map((key) => [key, set[key]])) };
}

/** The design with what came before and after it and the pose of the parts; of parts that are gone nothing is said any more, and where
 * nothing is left it is as the file says now. */
function goneOn(set: Design, now: Design, reply: Opened): Parameters<typeof begin> {
  const { past, future } = history();
  const fits = (step: Step): boolean => fitsParts(step.design, reply);
  if (fitsParts(set, reply)) return [set, { past: past.filter(fits), future: future.filter(fits) }, pose.peek()];
  const there = new Set(reply.parts.map((part) => part.name));
  const all = (names: readonly string[]): boolean => names.every((name) => there.has(name));
  const left = <T,>(some: T[], kept: (one: T) => boolean, otherwise: T[]): T[] => (some.some(kept) ? some.filter(kept) : otherwise);
  return [{
    ...set, extra: Object.fromEntries(Object.entries(set.extra).filter(([name]) => there.has(name))), gaps: set.gaps?.filter(([a, b]) => all([a, b])),
    fixed: left(set.fixed, (name) => there.has(name), now.fixed), glue: set.glue.filter(all),
    goals: typeof set.goals === "string" ? set.goals : left(set.goals, (goal) => there.has(goal.part), list(now.goals)),
  }];
}

/** Says that the design of the link in the address is not the one that is shown. */
function leftOut(name: string): void {
  if (!isLink()) return;
  const link = linked();
  if (link && link.name !== name) return otherFile(link.name);
  leaveLink();
  state.notice.value = link ? `The link is about another version of ${name}: its design is left out.` : BROKEN_LINK;
}
const BROKEN_LINK = "The link is not whole: the design that it carries is left out.";
const otherFile = (name: string): void => void (state.notice.value = `The link carries a design for ${name}: open that file.`);

function reopen(): void {
  if (pendingFile) return openAs(pendingFile); // it was chosen before the line was there, or as it broke
  again = state.drawing.peek() !== null;
  const link = state.file.peek() ? null : linked();
  if (link?.sample) return openAs({ name: link.sample, sample: true });
  const { file } = state;
  const before = link ? [keptFile(), ...recent()].find((one) => one?.name === link.name) : (file.peek() ?? keptFile());
  if (!file.peek() && isLink() && !link) state.notice.value = BROKEN_LINK; // and again once a file is open
  if (link && before) return openAs("data" in before ? { name: before.name, data: before.data, ...(before.reading && { reading: before.reading }) } : before);
  if (link) otherFile(link.name);
  else if (before) ask("open", requestFor((file.value = before as Opening)));
}

function worker(now: "ready" | "lost" | "restarted"): void {
  state.workerState.value = now;
  // what was under way is tried once more by the server, under the same number
  if (now === "restarted" && !quick && state.drawing.peek() && !state.answer.peek() && goals.peek().length) askFlex();
}

/** A line about nothing in particular. */
const said = (words: string): Fault => ({ about: "parts", words, parts: [], point: null, mends: [], missing: false });

function failed(of: string, lines: Fault[], about?: Design): void {
  if (about && about !== design.peek() && !["flex", "shape", "drag"].includes(of)) {
    state.notice.value = `of an earlier design: ${lines.map((one) => one.words).join("; ")}`;
    return;
  }
  if (of === "flex") {
    const again = quick?.again;
    quick = null;
    if (again) return askFlex(); // it failed for a design that has been changed since
    state.waiting.value = false;
    state.answer.value = null;
    if (!pose.peek() && (shown.peek().what !== "drag" || !state.dragged.peek())) showRest();
  }
  if (of === "drag") {
    drag = null;
    lead.value = null;
  }
  if (of === "open") {
    state.opening.value = "";
    pendingFile = returning = null;
    sameQuestion = false;
    if (!state.drawing.peek()) {
      state.file.value = null;
      forgetFile();
    }
    state.unopened.value = lines.map((one) => one.words);
    state.sheetOpen.value = true;
    return;
  }
  const answers = ["flex", "shape", "drag"].includes(of);
  if (!answers && reviewed === design.peek() && state.findings.peek().length) return; // what is wrong with the design stands there already, with what would help
  state.trouble.value = of;
  reviewed = answers ? design.peek() : null;
  state.pointed.value = null;
  state.findings.value = lines;
  if (lines.length && state.drawing.peek() && state.tab.peek() !== "sheet") {
    if (ofSheet(of)) state.tab.value = "sheet";
    state.sheetOpen.value = true;
  }
}

/** Sets the gap; steps of one pull of the slider are undone together. */
export const setGap = (gap: number, merge = "gap"): void => change({ gap: Math.max(0, Number(gap.toPrecision(6))) }, merge);
