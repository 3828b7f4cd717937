/** The state of a cutting sheet that is put together: what was found, and what was clicked as hints. */

import { computed, signal } from "@preact/signals";
import type { Assembled, LayReply, PlateHint, Point, SheetHints } from "./protocol.ts";

/** What the next click on the sheet says. */
export type Tool = "join" | "flush" | "lay" | "body" | "skip";

const NONE: SheetHints = { join: [], flush: [], groups: [], plate: [], skip: [] };

/** Requests about sheets. */
export const ofSheet = (kind: string): boolean => kind === "assemble" || kind === "lay";

export const thickness = signal(3);
/** By how much outlines are drawn larger; null: as the sheet says. */
export const burn = signal<number | null>(null);
export const hints = signal<SheetHints>(NONE);
/** Hints before each change, to go back to. */
export const past = signal<SheetHints[]>([]);
export const assembled = signal<Assembled | null>(null);
/** The answer to where a panel could lie. */
export const laid = signal<LayReply | null>(null);
export const tool = signal<Tool>("join");
/** Edges, or points of panels, that were pressed for the hint that is being made. */
export const picked = signal<readonly Picked[]>([]);
export interface Picked { panel: string; edge: string; at: Point }
/** Poses of the panel that was laid last, and which one is taken. */
export const poses = signal<{ plates: PlateHint[]; taken: number } | null>(null);
export const chosen = signal<string | null>(null);

export const panels = computed(() => new Map((assembled.value?.panels ?? []).map((panel) => [panel.name, panel])));
export const count = computed(() => Object.values(hints.value).reduce((sum, rows) => sum + rows.length, 0));
export const canUndo = computed(() => past.value.length > 0);

/** Forgets what was of the drawing before. */
export function forgetSheet(): void {
  hints.value = NONE;
  past.value = [];
  assembled.value = null;
  laid.value = null;
  picked.value = [];
  poses.value = null;
  chosen.value = null;
}
