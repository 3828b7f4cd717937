/** What the keyboard does, wherever no box is being typed in. */

import { design, goals, inSpace, setGoal, settle, togglePinned, togglePull, toggleTwist } from "./design.ts";
import { factor, play, playing, shown } from "./motion.ts";
import { isPull, type Point, type Triple } from "./protocol.ts";
import { askDrag, askModes, askReach, back, backToRest, cancel, fixOrNot, keepBeside, setGap } from "./session.ts";
import { fitAll, solidView, view, zoomBy } from "./stage/camera.ts";
import { kept } from "./stage/kept.ts";
import { chooseMany, lassoing } from "./stage/lasso.ts";
import { measuring, stopMeasuring } from "./stage/measure.ts";
import { holdSpace, releaseSpace } from "./stage/spaceBar.ts";
import { degrees } from "./words.ts";
import { gapStep } from "./chrome/GapStrip.tsx";
import { stepOfHistory } from "./chrome/NumberBox.tsx";
import { glueOrNot, seePast } from "./chrome/Selection.tsx";
import { pages } from "./panels/Panel.tsx";
import * as state from "./state.ts";

const ARROWS: Record<string, Point> = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const LONG = ["assemble", "lay", "tighten", "sample", "gap", "prove", "sweep", "check", "limit", "plan", "rank", "space", "save", "wiggle", "reach", "flex"] as const;
const STEP = 14; // pixels that a part is asked to go by one press
const TURN = 0.12; // radians that the view in space turns by one press
const AXES = "xyz";
/** Keys for what there is of drawings alone. */
const OF_DRAWINGS = "mlr";

/** Where a part was asked to go by arrow keys so far. */
let target: { part: string; grip: Point | Triple; at: Point | Triple } | null = null;

export function listen(): void {
  addEventListener("keydown", (event) => {
    const on = event.target as HTMLElement;
    if (event.altKey || state.helpOpen.peek() || on.closest("[role=menu]")) return;
    const command = event.ctrlKey || event.metaKey ? commandOf(event) : null;
    if (command && !state.standalone.peek()) {
      event.preventDefault();
      return command();
    }
    if (event.ctrlKey || event.metaKey || on.matches("input:not([type=range]), select, textarea")) return;
    if (on.matches("input[type=range], [role=tab]") && (event.key in ARROWS || event.key === "Home" || event.key === "End")) return;
    if (on.matches("button, summary, a") && (event.key === " " || event.key === "Enter")) return;
    if (act(event)) event.preventDefault();
  });
  addEventListener("keyup", (event) => void (event.key === " " && releaseSpace() && play(!playing.peek())));
  addEventListener("blur", () => void releaseSpace());
}

/** What a key means with Control. */
function commandOf(event: KeyboardEvent): (() => void) | null {
  if (event.key.toLowerCase() === "o") return openOne;
  if (event.key.toLowerCase() === "s" && state.drawing.peek()) return openSaves;
  return stepOfHistory(event);
}

const openOne = (): void => document.getElementById("file")?.click();
const openSaves = (): void => document.querySelector<HTMLElement>(".savebutton")?.click();

/** True when the key meant something. */
function act(event: KeyboardEvent): boolean {
  const { key } = event;
  if (state.atStart.peek()) return key === "Escape" && !(state.atStart.value = false);
  if (!state.drawing.peek() && !"?o".includes(key)) return false;
  const name = state.selected.peek();
  const tabAt = Number(key) - 1;
  if (key in ARROWS) return arrow(ARROWS[key]!, event.shiftKey);
  if (inSpace() && OF_DRAWINGS.includes(key)) return false;
  if (key === "?") state.helpOpen.value = true;
  else if (key === " ") holdSpace();
  else if (key === "+" || key === "=") zoomBy(1.3);
  else if (key === "-") zoomBy(1 / 1.3);
  else if (key === "0") fitAll();
  else if (inSpace() && solidView.peek() && AXES.includes(key)) solidView.peek()!.along(AXES.indexOf(key));
  else if (key === "m") measuring.peek() ? stopMeasuring() : (measuring.value = true);
  else if (key === "." || key === ",") step(key === "." ? 1 : -1);
  else if (key === "Escape") escape();
  else if (key === "Home" && !state.standalone.peek()) backToRest();
  else if (tabAt >= 0 && tabAt < pages.peek().length) {
    state.tab.value = pages.peek()[tabAt]!.name;
    state.sheetOpen.value = true;
  } else if (state.standalone.peek()) return false;
  else if (key === "b") kept.peek() ? (kept.value = null) : keepBeside();
  else if (key === "l") lassoing.value = !lassoing.peek();
  else if (key === "a") chooseMany(state.names.peek());
  else if (key === "[" || key === "]") setGap(design.peek().gap + (key === "]" ? 1 : -1) * gapStep());
  else if (key === "o") openOne();
  else if (key === "s") openSaves();
  else if (key === "w") askModes(name ?? undefined);
  else if (!name) return false;
  else if (key === "r") askReach(name);
  else if (key === "t" && inSpace()) toggleTwist(name);
  else if (key === "h" && inSpace()) seePast(name);
  else if (key === "f") fixOrNot(name);
  else if (key === "p") togglePull(name);
  else if (key === "n") togglePinned(name);
  else if (key === "g") glueOrNot(name);
  else return false;
  return true;
}

function step(by: number): void {
  const names = state.names.peek();
  if (!names.length) return;
  const at = state.indexOf.peek().get(state.selected.peek() ?? "");
  state.many.value = new Set();
  state.pressed.value = null;
  state.selected.value = names[((at ?? (by > 0 ? -1 : 0)) + by + names.length) % names.length]!;
}

/** In space: turns the view; with Shift drags the chosen part a step in the plane of the picture. */
function spatialArrow([dx, dy]: Point, drags: boolean): boolean {
  const seen = solidView.peek();
  const name = state.selected.peek();
  if (!seen) return false;
  if (!drags) {
    seen.turn(dx * TURN, dy * TURN);
    return true;
  }
  const i = state.indexOf.peek().get(name ?? "");
  if (!name || i === undefined || design.peek().fixed.includes(name)) return false;
  const grip = state.solids.peek()!.reference[i]!;
  const from = stepFrom(name, grip, Math.hypot(...seen.across(i, STEP, 0)) / factor());
  const by = seen.across(i, dx * STEP, dy * STEP).map((v) => v / factor());
  target = { part: name, grip, at: from.map((v, k) => v + by[k]!) as Triple };
  askDrag(name, grip, target.at, false);
  return true;
}

/** Where the next step by a key begins: where the last one was to lead, or where the part was stopped before. */
function stepFrom<P extends Point | Triple>(name: string, grip: P, by: number): P {
  const goesOn = target?.part === name && (shown.peek().what === "drag" || state.running.peek().has("drag"));
  if (!target || !goesOn) target = { part: name, grip, at: grip };
  const stopped = state.dragged.peek()?.reply;
  return (stopped?.part === name && stopped.settled && stopped.distance > 4 * by ? stopped.reached : target.at) as P;
}

function arrow([dx, dy]: Point, fine: boolean): boolean {
  if (inSpace()) return spatialArrow([dx, dy], fine);
  const name = state.selected.peek();
  if (!name || state.standalone.peek()) return false;
  const index = goals.peek().findIndex((goal) => goal.part === name && isPull(goal));
  if (index >= 0) {
    const goal = goals.peek()[index]!;
    if (!isPull(goal)) return false;
    const turned = ((degrees(goal.direction) + (dx - dy < 0 ? 5 : -5)) * Math.PI) / 180;
    const to: Point = fine ? [Math.cos(turned), Math.sin(turned)] : [dx, dy];
    if (!fine) settle();
    setGoal(index, { ...goal, direction: to.map((v) => Number(v.toFixed(6)) + 0) as Point }, fine ? "aim" : "");
    return true;
  }
  const i = state.indexOf.peek().get(name);
  if (i === undefined || design.peek().fixed.includes(name)) return false;
  const grip = state.drawing.peek()!.parts[i]!.at.slice(0, 2) as Point;
  const by = STEP / view.peek().scale / factor();
  const from = stepFrom(name, grip, by);
  target = { part: name, grip, at: [from[0] + dx * by, from[1] + dy * by] };
  askDrag(name, grip, target.at, false);
  return true;
}

function escape(): void {
  if (measuring.peek()) stopMeasuring();
  else if (lassoing.peek()) lassoing.value = false;
  else if (state.gluing.peek()) state.gluing.value = null;
  else if (LONG.some((kind) => state.running.peek().has(kind) && (kind !== "flex" || state.running.peek().get(kind)))) {
    for (const kind of LONG) if (state.running.peek().has(kind)) cancel(kind);
  } else if (!["answer", "rest"].includes(shown.peek().what)) back();
  else if (state.sheetOpen.peek()) state.sheetOpen.value = false;
  else chooseMany([]);
}
