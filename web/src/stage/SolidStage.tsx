/** Parts in space: the canvas of three.js, told what to show by the signals of the page, and what the hand does on it. */

import { computed, effect, signal, untracked } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { menuAt } from "../chrome/ContextMenu.tsx";
import { design, fixedNames, goals } from "../design.ts";
import { end, factor, place, playing, pose, sampled, shown } from "../motion.ts";
import { askDrag, release } from "../session.ts";
import type { ContactEntry } from "../protocol.ts";
import type { SolidView } from "../stage3d.ts";
import * as state from "../state.ts";
import { solidEye, solidView } from "./camera.ts";
import { blameColour, colours, isDark } from "./colours.ts";
import { chooseMany } from "./lasso.ts";
import { choose } from "./Stage.tsx";
import { blame, roles } from "./roles.ts";

type Open = typeof import("../stage3d.ts").openStage;
const here = globalThis as { openStage?: Open };

export async function opener(): Promise<Open> {
  if (!here.openStage) await import("./space-view.js" as string);
  return here.openStage!;
}

const failed = signal("");
const grabbing = signal(false);
export const AXES: Record<"light" | "dark", [string, string, string]> = { light: ["#a02c22", "#2a6b4a", "#1f5f99"], dark: ["#f0a095", "#8fd0ac", "#8fc1ea"] };

/** How each part is to be painted. */
const looks = computed(() => {
  const row = colours();
  const shares = blame.value;
  return state.names.value.map((name, i) => {
    const [fill, edge] = row[roles.value[i] ?? "neutral"];
    const lit = state.selected.value === name || state.many.value.has(name);
    const over = state.hovered.value === name;
    return {
      name, fill: shares ? blameColour(row.blame, shares[i]!) : fill, edge: lit ? row.force : over ? row.ink : edge, see: state.outlined.value.has(name),
    };
  });
});

const NONE: ContactEntry[] = [];

/** Contacts where a motion ends, and what is asked. */
function marks() {
  const { what } = shown.peek();
  if (what === "escape") return null;
  const about = what === "drag" ? state.dragged.peek() : state.answer.peek();
  const there = what === "drag" || (what === "answer" && place.peek() >= 0.999);
  const contacts = there && about && !blame.peek() ? ("held" in about.reply ? about.reply.held : about.reply.contacts) : NONE;
  return { contacts, goals: goals.peek(), highlit: state.highlit.peek() };
}

function connected(box: HTMLElement, open: Open): () => void {
  const names = state.names;
  const view: SolidView = open(box, "", {
    pose: (now) => pose(now, names.peek().length, 7),
    end: () => endMotion.peek(),
    film: () => film.peek(),
    factor: () => factor(),
    exploded: () => state.exploded.peek(),
    section: () => state.section.peek(),
    marks,
    free: (part) => !fixedNames.peek().has(names.peek()[part]!),
    hover: (part) => void (state.hovered.value = part === null ? null : names.peek()[part]!),
    choose: (part) => choose(part === null ? null : names.peek()[part]!),
    joint: (parts) => chooseMany(parts),
    menu(part, at) {
      const name = part === null ? null : names.peek()[part]!;
      if (name) chooseMany([name]);
      menuAt.value = { ...at, part: name };
    },
    drag(part, grip, target) {
      grabbing.value = true;
      state.selected.value = names.peek()[part]!;
      state.many.value = new Set();
      askDrag(names.peek()[part]!, grip, target);
    },
    release() {
      grabbing.value = false;
      release();
    },
    seen: (eye) => void (solidEye.value = eye),
  });
  solidView.value = view;
  const canvas = box.querySelector("canvas")!;
  canvas.setAttribute("aria-roledescription", "assembly in space");
  const stops = [
    effect(() => {
      if (state.solids.value) view.solids(state.solids.value);
    }),
    effect(() => {
      void state.solids.value; // parts are made anew
      const { force, motion, pulled } = colours();
      view.looks(looks.value, { force, motion, ghost: pulled[1], axes: AXES[isDark() ? "dark" : "light"] });
    }),
    effect(() => {
      void [shown.value, place.value, playing.value, factor(), state.exploded.value, state.section.value, state.answer.value, state.dragged.value, state.highlit.value, blame.value, design.value];
      view.ask();
    }),
    effect(() => {
      void [shown.value, factor()];
      if (!["drag", "between"].includes(shown.value.what)) untracked(view.keepFitted);
    }),
    effect(() => {
      const label = `${names.value.length} parts in space, gap ${design.value.gap} mm. Arrow keys turn the view, full stop and comma choose a part, Shift and arrow keys drag it, question mark lists all keys.`;
      canvas.setAttribute("aria-label", label);
    }),
  ];
  return () => {
    for (const stop of stops) stop();
    solidView.value = solidEye.value = null;
    view.remove();
  };
}

export function SolidStage() {
  const box = useRef<HTMLDivElement>(null);
  const opened = state.drawing.value;
  useEffect(() => {
    let leave: (() => void) | null = null;
    let gone = false;
    failed.value = "";
    opener().then(
      (open) => {
        if (!gone && box.current) leave = connected(box.current, open);
      },
      () => (failed.value = "The 3D view could not be loaded."),
    ).catch(() => (failed.value = "This browser shows no 3D pictures (WebGL)."));
    return () => {
      gone = true;
      leave?.();
    };
  }, [opened]);
  const over = state.hovered.value !== null && !fixedNames.value.has(state.hovered.value);
  return (
    <div class="stage solid" ref={box} data-unsure={state.unsure.value || shown.value.what === "between"} data-cursor={grabbing.value ? "grabbing" : over ? "grab" : "default"}>
      {failed.value && <p class="drop" role="alert">{failed.value}</p>}
    </div>
  );
}

/** Motion that is shown at its end: of a part, where something is shown. */
/** So many places of a film at most are looked at to fit it. */
const MOST_PLACES = 12;
const film = computed(() => {
  const { frames, until } = shown.value;
  return frames && frames.n === state.names.value.length ? sampled(frames, MOST_PLACES, until) : [];
});
const endMotion = computed(() => {
  const { frames } = shown.value;
  return frames && frames.n === state.names.value.length ? end(frames) : null;
});
