/** The design: what the user set, with undo and redo. Every change is a new object. */

import { batch, computed, signal } from "@preact/signals";
import { type Design, type Goal, type Goals, isTwist } from "./protocol.ts";
import { own } from "./words.ts";

/** Of what is open: 3 for an assembly in space. */
export const dimension = signal<2 | 3>(2);
export const inSpace = (): boolean => dimension.value === 3;

const NOTHING: Design = { gap: 0, extra: {}, fixed: [], glue: [], goals: [] };

export const design = signal<Design>(NOTHING);
/** Where parts were left: motions of those that do not rest, by name; null where the answer, or rest, is shown. */
export type Pose = Readonly<Record<string, readonly number[]>>;
export const pose = signal<Pose | null>(null);
/** Parts that stand while another one is dragged, although they are not fixed. */
export const pinned = signal<ReadonlySet<string>>(new Set());

/** What undo and redo lead to. */
export interface Step { design: Design; pose: Pose | null }
const past = signal<Step[]>([]);
const future = signal<Step[]>([]);
export const canUndo = computed(() => past.value.length > 0);
export const canRedo = computed(() => future.value.length > 0);

const DEEPEST = 200;
let merging = "";

/** Steps before and after the present one. */
export interface History { past: Step[]; future: Step[] }
export const history = (): History => ({ past: past.peek(), future: future.peek() });

const now = (): Step => ({ design: design.peek(), pose: pose.peek() });
function become(step: Step): void {
  batch(() => {
    design.value = step.design;
    pose.value = step.pose;
  });
  merging = "";
}

/** Begins anew with a design that was read, and with what came before and after it if that is known. */
export function begin(read: Design, before: History = { past: [], future: [] }, left: Pose | null = null): void {
  past.value = before.past;
  future.value = before.future;
  pinned.value = new Set();
  become({ design: read, pose: left });
}

function keepStep(merge: string): void {
  if (!merge || merge !== merging) past.value = [...past.value.slice(-DEEPEST), now()];
  merging = merge;
  future.value = [];
}

/** Changes the design, whose answer is seen then. Changes with the same `merge` word that follow each other are undone in one step. */
export function change(next: Partial<Design>, merge = ""): void {
  keepStep(merge);
  batch(() => {
    design.value = { ...design.value, ...next };
    pose.value = null;
  });
}

/** Leaves parts where they are; null takes all back. */
export function leave(next: Pose | null, merge = ""): void {
  if (next === pose.peek()) return;
  keepStep(merge);
  pose.value = next;
}

/** The pose is another one than was thought: no step of its own. */
export function correctPose(next: Pose | null): void {
  pose.value = next;
}

/** The next change is a step of its own even if its word is the same. */
export function settle(): void {
  merging = "";
}

export function undo(): void {
  const last = past.value.at(-1);
  if (!last) return;
  past.value = past.value.slice(0, -1);
  future.value = [...future.value, now()];
  become(last);
}

export function redo(): void {
  const next = future.value.at(-1);
  if (!next) return;
  future.value = future.value.slice(0, -1);
  past.value = [...past.value, now()];
  become(next);
}

export function togglePinned(name: string): void {
  const next = new Set(pinned.peek());
  if (!next.delete(name)) next.add(name);
  pinned.value = next;
}

export const list = (goals: Goals): Goal[] => (typeof goals === "string" ? [] : goals);
export const goals = computed(() => list(design.value.goals));
export const fixedNames = computed(() => new Set(design.value.fixed));
export const pulledNames = computed(() => new Set(goals.value.map((goal) => goal.part)));

/** Fixes a part, which then cannot be pulled any more; or lets it go. */
export function toggleFixed(name: string): void {
  const { fixed } = design.value;
  if (fixed.includes(name)) change({ fixed: fixed.filter((other) => other !== name) });
  else change({ fixed: [...fixed, name], ...(pulledNames.value.has(name) && { goals: goals.value.filter((goal) => goal.part !== name) }) });
}

/** Fixes many parts, or lets them go. */
export function fixAll(names: readonly string[], on: boolean): void {
  const others = design.value.fixed.filter((name) => !names.includes(name));
  change({ fixed: on ? [...others, ...names] : others, ...(on && typeof design.value.goals !== "string" && { goals: goals.value.filter((goal) => !names.includes(goal.part)) }) });
}

export function setGoal(index: number, goal: Goal, merge = ""): void {
  const fixed = design.value.fixed.filter((name) => name !== goal.part); // what is pulled must not stand
  change({ goals: goals.value.map((old, i) => (i === index ? goal : old)), ...(fixed.length < design.value.fixed.length && { fixed }) }, merge);
}

export function removeGoal(index: number): void {
  change({ goals: goals.value.filter((_, i) => i !== index) });
}

/** Pulls this part alone, the way that was asked for before; off again where it was pulled already. */
export function togglePull(name: string): void {
  const mine = goals.value.findIndex((goal) => goal.part === name && !isTwist(goal));
  if (mine >= 0) return removeGoal(mine);
  const before = goals.value.find((goal) => goal.direction);
  const direction = before?.direction ?? (inSpace() ? [0, 0, 1] : [1, 0]);
  askFor({ part: name, direction });
}

/** Twists this part alone about the axis that was asked for before; off again where it was twisted already. */
export function toggleTwist(name: string): void {
  const mine = goals.value.findIndex((goal) => goal.part === name && isTwist(goal));
  if (mine >= 0) return removeGoal(mine);
  const before = goals.value.find((goal) => goal.part === name)?.direction;
  askFor({ part: name, turn: before?.length === 3 ? before : [0, 0, 1] });
}

/** Asks for this alone; what is asked to move does not stand. */
function askFor(goal: Goal): void {
  change({ goals: [goal], fixed: design.value.fixed.filter((other) => other !== goal.part) });
}

export const groupOf = (name: string): string[] | undefined => design.value.glue.find((group) => group.includes(name));

/** Glues two parts, and with them the groups they are in. */
export function glue(a: string, b: string): void {
  if (a === b) return;
  const mine = design.value.glue.filter((group) => group.includes(a) || group.includes(b));
  const joined = [...new Set([...mine.flat(), a, b])];
  change({ glue: [...design.value.glue.filter((group) => !mine.includes(group)), joined] });
}

/** Glues many parts, and with them the groups they are in. */
export function glueAll(names: readonly string[]): void {
  const mine = design.value.glue.filter((group) => group.some((name) => names.includes(name)));
  change({ glue: [...design.value.glue.filter((group) => !mine.includes(group)), [...new Set([...mine.flat(), ...names])]] });
}

export function unglue(name: string): void {
  const rest = design.value.glue.map((group) => group.filter((other) => other !== name)).filter((group) => group.length > 1);
  change({ glue: rest });
}

/** Extra gap round a part [mm]. */
export const extraOf = (name: string): number => own(design.value.extra, name) ?? 0;

/** The same extra gap round some parts. */
export function setExtras(names: readonly string[], value: number, merge = ""): void {
  const others = Object.entries(design.value.extra).filter(([name]) => !names.includes(name));
  change({ extra: Object.fromEntries(value === 0 ? others : [...others, ...names.map((name) => [name, value] as const)]) }, merge);
}

const isJoint = (pair: readonly string[], [a, b]: readonly string[]): boolean => pair.includes(a!) && pair.includes(b!);

/** The gap of the joint of two parts [mm], where it has one of its own. */
export const jointGap = (a: string, b: string): number | null => design.value.gaps?.find(([one, other]) => isJoint([one, other], [a, b]))?.[2] ?? null;

/** Gives a joint a gap of its own; null gives it that of all others. */
export function setJointGap(a: string, b: string, value: number | null, merge = ""): void {
  const others = (design.value.gaps ?? []).filter(([one, other]) => !isJoint([one, other], [a, b]));
  change({ gaps: value === null ? others : [...others, [a, b, value]] }, merge);
}

/** Text that is the same for designs that differ in the gap alone. */
export const questionOf = (one: Design): string => JSON.stringify({ ...one, gap: 0 });
export const question = computed(() => questionOf(design.value));

/** True where anything is asked of the parts. */
export const asks = ({ goals }: Design): boolean => typeof goals === "string" || goals.length > 0;
