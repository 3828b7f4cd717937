/** What outlives a reload in this tab: the file that was dropped, the design; and in this browser: the token, recent files. */

import type { History, Pose, Step } from "./design.ts";
import { type Design, fromBase64, type HowRead, type Made, type Opened, toBase64 } from "./protocol.ts";

/** A file that was dropped and how it is to be read, or a sample by its name, or what is made here, or the file of the command. */
export type Opening = { name: string; data: string; reading?: HowRead } | { name: string; sample: true } | { name: string; make: Made } | { name: string; served: true };

const read = (key: string): string | null => {
  try {
    return sessionStorage.getItem(`wiggleroom.${key}`);
  } catch {
    return null;
  }
};
const write = (key: string, text: string | null): void => {
  try {
    if (text === null) sessionStorage.removeItem(`wiggleroom.${key}`);
    else sessionStorage.setItem(`wiggleroom.${key}`, text);
  } catch {
    // Full or forbidden: a reload then begins with the file as it is.
  }
};

/** Token of the address, moved out of it at once so that it is not copied with it. */
export function token(): string {
  const address = new URL(location.href);
  const given = address.searchParams.get("token");
  if (given) {
    if (given !== read("token")) for (const key of ["file", "design", "reading", "served"]) write(key, null); // another server: what was kept is not its own
    write("token", given);
    address.searchParams.delete("token");
    history.replaceState(null, "", address.href);
  }
  if (given) remember(given);
  return given ?? read("token") ?? "";
}

/** Keeps the token for other tabs of this browser, so that a link leads here while the server runs. */
function remember(given: string): void {
  try {
    localStorage.setItem("wiggleroom.token", given);
  } catch {
    // Forbidden: then the whole address is needed.
  }
}

export const keepFile = (file: Opening): void => write("file", JSON.stringify(file));
/** Files opened here before, the last one first; they stay in this browser. */
export interface Recent { name: string; data: string; reading?: HowRead; when: number }
const RECENT = "wiggleroom.recent";
const MAX_RECENT = 6;
const MAX_KEPT = 3_000_000;

export function recent(): Recent[] {
  try {
    return JSON.parse(localStorage.getItem(RECENT) ?? "[]") as Recent[];
  } catch {
    return [];
  }
}

export function keepRecent({ name, data, reading }: Omit<Recent, "when">): void {
  let left = MAX_KEPT;
  const all = [{ name, data, ...(reading && { reading }), when: Date.now() }, ...recent().filter((one) => one.name !== name)].slice(0, MAX_RECENT);
  const kept = all.filter((one) => (left -= one.data.length) > 0);
  try {
    localStorage.setItem(RECENT, JSON.stringify(kept));
  } catch {
    // Full or forbidden: the list then stays as it is.
  }
}

export function forgetRecent(): void {
  try {
    localStorage.removeItem(RECENT);
  } catch {
    // Forbidden: then there is none.
  }
}

/** How the drawing of the command line was read again. */
export const keepReading = (name: string, reading: HowRead): void => write("reading", JSON.stringify({ name, reading }));
export function keptReading(name: string): HowRead | null {
  const kept = JSON.parse(read("reading") ?? "null") as { name: string; reading: HowRead } | null;
  return kept?.name === name ? kept.reading : null;
}

/** Name of the file that the command was given: after a reload the server opens the one that was dropped here. */
export const keepServed = (name: string): void => write("served", name);
export const keptServed = (): string => read("served") ?? "";

export const forgetFile = (): void => write("file", null);
export function keptFile(): Opening | null {
  const text = read("file");
  return text ? (JSON.parse(text) as Opening) : null;
}

export const mark = (of: Opened): string => `${of.name}|${of.gap}|${of.parts.length}|${of.size.join(",")}`;

/** What an address says after its #: a design, of a sample or of the drawing with that mark. */
interface Linked { name: string; mark: string; design: Design; sample?: string }

const isText = (one: unknown): boolean => typeof one === "string";
const all = (list: unknown, each: (one: unknown) => boolean): boolean => Array.isArray(list) && list.every(each);
const numbers = (list: unknown): boolean => all(list, Number.isFinite);

/** Whether something is a design: what was kept or linked may come from another version of the page, or from any hand. */
export function isDesign(one: unknown): one is Design {
  const { gap, extra, gaps, fixed, glue, goals } = Object(one) as Record<string, unknown>;
  return Number.isFinite(gap) && (gap as number) >= 0 && extra instanceof Object && numbers(Object.values(extra)) && all(fixed, isText)
    && (gaps === undefined || all(gaps, isJointGap)) && all(glue, (group) => all(group, isText)) && (isText(goals) || all(goals, isGoal));
}

const isJointGap = (one: unknown): boolean => Array.isArray(one) && one.length === 3 && isText(one[0]) && isText(one[1]) && Number.isFinite(one[2]) && one[2] >= 0;

const isPose = (one: unknown): one is Pose | null | undefined => one == null || (one instanceof Object && Object.values(one).every(numbers));
function isStep(one: unknown): one is Step {
  const { design, pose } = Object(one) as Record<string, unknown>;
  return isDesign(design) && isPose(pose);
}

function isGoal(one: unknown): boolean {
  const { part, direction, point, turn, w } = Object(one) as Record<string, unknown>;
  return isText(part) && [direction, point, turn, w].every((said) => said == null || numbers(said) || (said === turn && isText(said)));
}

/** Address of this page that carries the design; whoever opens it needs the same file, unless it is a sample. */
export function linkTo(of: Opened, design: Design, sample?: string): string {
  const text = JSON.stringify({ name: of.name, mark: mark(of), design, sample } satisfies Linked);
  const data = toBase64(new TextEncoder().encode(text)).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
  return `${location.origin}/#state=${data}`;
}

export const isLink = (): boolean => /[#&]state=/.test(location.hash);

/** What the link in the address says; null where there is none, or where it is not whole. */
export function linked(): Linked | null {
  const data = /[#&]state=([\w-]+)/.exec(location.hash)?.[1];
  if (!data) return null;
  try {
    const told = JSON.parse(new TextDecoder().decode(fromBase64(data.replaceAll("-", "+").replaceAll("_", "/")))) as Linked;
    return isText(told.name) && isText(told.mark) && isDesign(told.design) ? told : null;
  } catch {
    return null;
  }
}

/** From now on what is set in the page counts. */
export const leaveLink = (): void => history.replaceState(null, "", location.pathname);

const MAX_STEPS = 40;
interface KeptDesign { mark: string; design: Design; pose?: Pose | null; history?: History; when: number; server: string }

/** Designs of the files that were open last, each with its undo; they stay in this browser. */
const DESIGN = "wiggleroom.design|";
const MAX_DESIGNS = 60;
const LATER = 300; // ms
let waiting: { key: string; text: string; timer: number } | null = null;

/** Keeps the design with the last steps of undo and redo: for this tab, and for whenever the file is opened again. */
export function keepDesign(of: Opened, design: Design, pose: Pose | null, { past, future }: History): void {
  const slim = (steps: readonly Step[]): Step[] => steps.map((step) => ({ design: step.design, pose: small(step.pose) }));
  const history = { past: slim(past.slice(-MAX_STEPS)), future: slim(future.slice(-MAX_STEPS)) };
  const text = JSON.stringify({ mark: mark(of), design, pose: small(pose), history, when: Date.now(), server: read("token") ?? "" } satisfies KeptDesign);
  write("design", text);
  const key = DESIGN + mark(of);
  if (waiting && waiting.key !== key) flush();
  clearTimeout(waiting?.timer);
  waiting = { key, text, timer: window.setTimeout(flush, LATER) }; // a slider that moves keeps a hundred
}

/** A pose of more parts than these is not kept: it would leave no room for designs. */
const MAX_LEFT = 300;
const small = (pose: Pose | null): Pose | null => (pose && Object.keys(pose).length > MAX_LEFT ? null : pose);

/** Writes what waits to be kept. */
export function flush(): void {
  if (!waiting) return;
  clearTimeout(waiting.timer);
  const { key, text } = waiting;
  waiting = null;
  try {
    const others = designs().filter((one) => one !== key);
    for (const old of others.splice(MAX_DESIGNS - 1)) localStorage.removeItem(old);
    while (!putIn(key, text) && others.length) localStorage.removeItem(others.pop()!); // full: the oldest goes
  } catch {
    // Forbidden: the design then is kept in this tab alone, while its file is open.
  }
}
if (typeof addEventListener === "function") addEventListener("pagehide", flush);

function putIn(key: string, text: string): boolean {
  try {
    localStorage.setItem(key, text);
    return true;
  } catch {
    return false;
  }
}

/** Keys of the designs that are kept, the newest first. */
function designs(): string[] {
  const keys = Array.from({ length: localStorage.length }, (_, i) => localStorage.key(i)!).filter((key) => key.startsWith(DESIGN));
  const when = new Map(keys.map((key) => [key, (JSON.parse(localStorage.getItem(key)!) as KeptDesign).when]));
  return keys.sort((a, b) => when.get(b)! - when.get(a)!);
}

export function forgetDesigns(): void {
  try {
    for (const key of designs()) localStorage.removeItem(key);
  } catch {
    // Forbidden: then there are none.
  }
}

export interface Before { design: Design; pose?: Pose | null; history?: History; from: "link" | "tab" | "browser" }

/** What was set for a drawing before; what options of this server said counts only while it runs: `served`. */
export function keptDesign(of: Opened, served: boolean): Before | null {
  const told = linked();
  if (told?.mark === mark(of)) {
    leaveLink();
    return { design: told.design, from: "link" };
  }
  const mine = sound(read("design"), of);
  if (mine) return { ...mine, from: "tab" };
  const old = sound(stored(DESIGN + mark(of)), of);
  return old && (!served || old.server === read("token")) ? { ...old, from: "browser" } : null;
}

function stored(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** A kept design that is one, and whose parts are all there: the file may be another one of its name. */
function sound(text: string | null, of: Opened): KeptDesign | null {
  const kept = JSON.parse(text ?? "null") as KeptDesign | null;
  if (!kept || kept.mark !== mark(of) || !isDesign(kept.design) || !isPose(kept.pose) || ![kept.history?.past, kept.history?.future].every((list) => all(list, isStep))) return null;
  return fitsParts(kept.design, of) ? kept : null;
}

/** Whether all parts that a design names are there. */
export function fitsParts({ extra, gaps, fixed, glue, goals }: Design, of: Opened): boolean {
  const there = new Set(of.parts.map((part) => part.name));
  const named = [...Object.keys(extra), ...(gaps ?? []).flatMap(([a, b]) => [a, b]), ...fixed, ...glue.flat(), ...(typeof goals === "string" ? [] : goals.map((goal) => goal.part))];
  return named.every((name) => there.has(name));
}
