/** The canvas with the parts, and what the pointer does on it. */

import { computed, effect, untracked, useComputed } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { menuAt } from "../chrome/ContextMenu.tsx";
import { design, fixedNames, glue } from "../design.ts";
import { end, factor, place, playing, pose, sampled, shown } from "../motion.ts";
import type { Point } from "../protocol.ts";
import { askDrag, askReach, release } from "../session.ts";
import * as state from "../state.ts";
import { bringIntoView, content, fitAll, fitted, keepFitted, panBy, pointIn, size, view, wheelFactor, zoomBy } from "./camera.ts";
import { colours } from "./colours.ts";
import { groupAt, lead, led, type Wanted } from "./lead.ts";
import { chooseMany, chooseToo, close, draw, lassoing } from "./lasso.ts";
import { contactAt, cost, current, frame, gripAt, partAt, pointerTarget } from "./now.ts";
import { paintMarks } from "./marks.ts";
import { measuring, pick, picked } from "./measure.ts";
import { clear, paint, paintGhost, paintOver, type Scene } from "./paint.ts";
import { Overlay } from "./Overlay.tsx";
import { Retained, SHARE, UNSEEN } from "./retained.ts";
import { blame, roles } from "./roles.ts";
import { around, outOf, placed, shapes } from "./shapes.ts";
import { spaceHeld, useSpace } from "./spaceBar.ts";
import { toWorld } from "./view.ts";

const SLOW = 36;
/** So long after the view has changed for the last time [ms] everything is painted as it should be. */
const STILL = 120;
const NONE: ReadonlySet<number> = new Set();
/** Of so few parts the reach is worked out when one is pressed. */
const AT_ONCE = 25;

/** Indices of the chosen parts. */
const chosen = computed<ReadonlySet<number>>(() => {
  const some = state.many.value.size ? [...state.many.value] : state.selected.value ? [state.selected.value] : [];
  return new Set(some.flatMap((name) => state.indexOf.value.get(name) ?? []));
});

/** So many places of a film at most are looked at to fit it. */
const MOST_SEEN = 24;
/** Parts that leave are followed so many times the drawing's longer side. */
const MOST_FAR = 2;

function painter(canvas: HTMLCanvasElement): () => void {
  const g = canvas.getContext("2d", { alpha: false })!;
  let wanted = 0;
  let still = 0;
  let rough = false;
  let lastView = view.peek();
  let hand: Wanted | null = null;
  let handAt = pointerTarget.peek();
  const retained = new Retained();
  /** Draws a frame; true where what is wanted was not reached in it. */
  const draw = (now: number): boolean => {
    wanted = 0;
    if (!size.peek().width || !state.drawing.peek()) return false;
    const { motion, moving } = pose(now, current.shapes.length);
    const changing = moving || lastView !== view.peek();
    lastView = view.peek();
    rough = changing && (rough || cost.last > SLOW);
    const ratio = canvas.width / size.peek().width;
    const at = state.indexOf.peek();
    hand = lead.peek() ?? (retained.behind && hand && at.has(hand.part) ? hand : null); // until the bitmap shows what was answered
    const held = hand ? groupAt(hand.part) : NONE;
    let scene: Scene = {
      shapes: current.shapes, names: state.names.peek(), roles: roles.peek(), blame: blame.peek(),
      motion, of: shown.peek().what === "drag" ? String(state.dragged.peek()?.reply.id ?? "left") : shown.peek().what, factor: factor(), chosen: chosen.peek(), hovered: hand ? -1 : (at.get(state.hovered.peek() ?? "") ?? -1), held: moving ? NONE : held, colours: colours(),
    };
    if (changing) {
      clear(g, scene.colours);
      paint(g, size.peek(), ratio, view.peek(), scene, rough);
      current.motion = motion;
    } else {
      scene = retained.show(g, { size: size.peek(), ratio, view: view.peek(), scene }, pointerTarget.peek() ? UNSEEN : 0, handAt === pointerTarget.peek() ? SHARE.resting : SHARE.moving);
      handAt = pointerTarget.peek();
      current.motion = scene.motion;
    }
    if (hand && !moving) {
      const { free, desired } = led(hand, scene.motion);
      const moved = (current.motion = scene.motion.slice());
      for (const i of held) [moved[3 * i], moved[3 * i + 1]] = [moved[3 * i]! + free[0], moved[3 * i + 1]! + free[1]];
      scene = { ...scene, motion: moved };
      paintOver(g, size.peek(), ratio, view.peek(), scene, held);
      if (lead.peek()) paintGhost(g, size.peek(), ratio, view.peek(), scene, held, [desired[0] - free[0], desired[1] - free[1]]);
    }
    const marks = marksNow();
    current.spots = !marks ? [] : paintMarks(g, size.peek(), ratio, view.peek(), scene.colours, current.shapes, at, current.motion, scene.factor, marks);
    requestAnimationFrame((next) => { // painting goes on after this function: only the next frame tells
      cost.last = next - now;
      retained.tune(next - now);
    });
    frame.value++;
    clearTimeout(still);
    if (moving || retained.behind) invalidate();
    else if (changing) still = window.setTimeout(() => ((rough = false), (cost.last = 0), invalidate()), STILL);
    canvas.dataset.shown = scene.of;
    canvas.dataset.view = JSON.stringify([view.peek().x, view.peek().y, view.peek().scale]);
    return retained.behind && !changing;
  };
  const invalidate = (): void => {
    if (!wanted) wanted = requestAnimationFrame(draw);
  };
  const printed = (): void => { // paper does not wait for frames
    while (draw(performance.now()));
  };
  addEventListener("beforeprint", printed);
  const stopShapes = effect(() => {
    const opened = state.drawing.value;
    current.shapes = opened ? shapes(opened.parts, state.rings.value) : [];
    if (picked.peek().length) picked.value = []; // other outlines
    invalidate();
  });
  const stopBox = effect(() => {
    const opened = state.drawing.value;
    const { frames } = shown.value;
    void state.rings.value;
    if (!opened || shown.value.what === "between" || (shown.value.what === "drag" && pointerTarget.value)) return; // the hand needs a view that stays
    const film = frames && frames.n === current.shapes.length ? sampled(frames, MOST_SEEN, shown.value.until) : [];
    content.value = around(current.shapes, opened.size, film, factor(), MOST_FAR);
    keepFitted();
  });
  const stopFit = effect(() => {
    if (state.drawing.value && size.value.width) untracked(fitAll);
  });
  const stopSpot = effect(() => {
    const place = state.pointed.value?.point;
    if (place) untracked(() => bringIntoView(place));
  });
  const stop = effect(() => {
    void [view.value, size.value, shown.value, place.value, factor(), roles.value, blame.value, colours(), chosen.value];
    void [lead.value, playing.value, state.hovered.value, state.highlit.value, state.answer.value, state.dragged.value, pointerTarget.value];
    invalidate();
  });
  return () => {
    removeEventListener("beforeprint", printed);
    stopShapes();
    stopBox();
    stopFit();
    stopSpot();
    stop();
    cancelAnimationFrame(wanted);
  };
}

function marksNow() {
  const what = shown.peek().what;
  const thread = threadNow();
  if (what === "drag" && state.dragged.peek()) {
    const about = state.dragged.peek()!;
    return { contacts: about.reply.held, at: end(about.paths[0]!), thread, highlit: null };
  }
  const about = state.answer.peek();
  if (what !== "answer" || !about?.paths[0] || place.peek() < 0.999 || blame.peek()) return null;
  return { contacts: about.reply.contacts, at: end(about.paths[0]), thread, highlit: state.highlit.peek() as Point | null };
}

/** From where the dragged point is drawn to where it is wanted. */
function threadNow(): { from: Point; to: Point } | null {
  const now = pointerTarget.peek();
  const i = now ? state.indexOf.peek().get(now.part) : undefined;
  if (!now || i === undefined) return null;
  const shape = current.shapes[i]!;
  const f = factor();
  const local: Point = [now.grip[0] - shape.at[0], now.grip[1] - shape.at[1]];
  const to: Point = [now.grip[0] + (now.target[0] - now.grip[0]) * f, now.grip[1] + (now.target[1] - now.grip[1]) * f];
  return { from: outOf(placed(shape, current.motion, i, f), local), to };
}

interface Held { at: Point; moved: boolean; part: string | null; grip: Point }

function pointers(canvas: HTMLCanvasElement): () => void {
  const down = new Map<number, Held>();
  let lassoPointer = -1;
  const here = (event: PointerEvent): Point => pointIn(canvas, event);
  const press = (event: PointerEvent): void => {
    if (event.button > 1 || !state.drawing.peek()) return;
    canvas.setPointerCapture(event.pointerId);
    const at = here(event);
    if (event.button === 0 && (lassoing.peek() || event.shiftKey) && down.size === 0 && !state.standalone.peek()) {
      if (lassoing.peek() || partAt(at) === null) {
        lassoPointer = event.pointerId;
        return draw(at);
      }
    }
    if (spaceHeld.peek()) useSpace();
    const name = event.button === 0 && down.size === 0 && !measuring.peek() && !spaceHeld.peek() ? partAt(at) : null;
    const grip = name ? gripAt(name, at) : ([0, 0] as Point);
    down.set(event.pointerId, { at, moved: false, part: name, grip });
  };
  const move = (event: PointerEvent): void => {
    const held = down.get(event.pointerId);
    const at = here(event);
    if (lassoPointer === event.pointerId) return draw(at);
    if (!held) {
      if (event.pointerType !== "touch") state.hovered.value = partAt(at);
      return;
    }
    if (down.size === 2) return pinch(held, at);
    if (!held.moved && Math.hypot(at[0] - held.at[0], at[1] - held.at[1]) < (event.pointerType === "touch" ? 8 : 4)) return;
    held.moved = true;
    const free = held.part !== null && !fixedNames.peek().has(held.part) && !state.standalone.peek();
    if (free) dragTo(held, at);
    else {
      panBy(at[0] - held.at[0], at[1] - held.at[1]);
      held.at = at;
    }
  };
  const pinch = (held: Held, at: Point): void => {
    const other = [...down.values()].find((one) => one !== held)!;
    const [before, after] = [held.at, at].map((p) => Math.hypot(p[0] - other.at[0], p[1] - other.at[1]));
    held.moved = other.moved = true;
    held.part = other.part = null;
    pointerTarget.value = null;
    panBy((at[0] - held.at[0]) / 2, (at[1] - held.at[1]) / 2);
    zoomBy(after! / Math.max(before!, 1), [(at[0] + other.at[0]) / 2, (at[1] + other.at[1]) / 2]);
    held.at = at;
  };
  const dragTo = (held: Held, at: Point): void => {
    const world = toWorld(view.peek(), size.peek(), at);
    const f = factor();
    const target: Point = [held.grip[0] + (world[0] - held.grip[0]) / f, held.grip[1] + (world[1] - held.grip[1]) / f];
    chooseMany([held.part!]);
    pointerTarget.value = { part: held.part!, grip: held.grip, target };
    askDrag(held.part!, held.grip, target);
  };
  const lift = (event: PointerEvent): void => {
    if (lassoPointer === event.pointerId) {
      lassoPointer = -1;
      lassoing.value = false;
      return close(event.shiftKey && state.many.peek().size > 0);
    }
    const held = down.get(event.pointerId);
    down.delete(event.pointerId);
    if (!held) return;
    if (pointerTarget.peek()) {
      pointerTarget.value = null;
      release();
    } else if (!held.moved && event.type === "pointerup") {
      if (spaceHeld.peek()) return;
      const contact = contactAt(here(event), event.pointerType === "touch" ? 14 : 8);
      if (measuring.peek()) pick(here(event));
      else if (event.shiftKey && held.part) chooseToo(held.part);
      else if (contact && !state.gluing.peek()) chooseMany(contact.parts);
      else {
        state.pressed.value = held.part ? held.grip : null;
        choose(held.part);
        if (held.part && state.names.peek().length <= AT_ONCE && !fixedNames.peek().has(held.part) && !state.standalone.peek()) askReach(held.part);
      }
    }
  };
  const wheel = (event: WheelEvent): void => {
    event.preventDefault();
    zoomBy(wheelFactor(event), pointIn(canvas, event));
  };
  const leave = (): void => void (state.hovered.value = null);
  const menu = (event: MouseEvent): void => {
    if (state.standalone.peek() || !state.drawing.peek()) return;
    event.preventDefault();
    const box = canvas.getBoundingClientRect();
    const part = partAt([event.clientX - box.left, event.clientY - box.top]);
    if (part) chooseMany([part]);
    menuAt.value = { x: event.clientX, y: event.clientY, part };
  };
  const gone = new AbortController();
  const { signal } = gone;
  canvas.addEventListener("pointerdown", press, { signal });
  canvas.addEventListener("pointermove", move, { signal });
  canvas.addEventListener("pointerup", lift, { signal });
  canvas.addEventListener("pointercancel", lift, { signal });
  canvas.addEventListener("pointerleave", leave, { signal });
  canvas.addEventListener("wheel", wheel, { passive: false, signal });
  canvas.addEventListener("dblclick", fitUnlessPart, { signal });
  canvas.addEventListener("contextmenu", menu, { signal });
  return () => gone.abort();
}

function fitUnlessPart(): void {
  if (!state.hovered.peek()) fitAll();
}

/** Selects a part; while gluing, glues it to the one chosen before. */
export function choose(name: string | null): void {
  const other = state.gluing.peek();
  state.gluing.value = null;
  if (other && name) glue(other, name);
  else chooseMany(name ? [name] : []);
}

export function Stage() {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const own = canvas.current!;
    const stopPainting = painter(own);
    const stopPointers = pointers(own);
    const watch = new ResizeObserver(([entry]) => {
      const ratio = window.devicePixelRatio || 1;
      const exact = entry!.devicePixelContentBoxSize?.[0];
      const { width, height } = entry!.contentRect;
      own.width = exact?.inlineSize ?? Math.round(width * ratio);
      own.height = exact?.blockSize ?? Math.round(height * ratio);
      size.value = { width, height };
      if (fitted.peek()) fitAll();
    });
    watch.observe(own);
    return () => {
      stopPainting();
      stopPointers();
      watch.disconnect();
    };
  }, []);
  const parts = state.drawing.value?.parts.length ?? 0;
  const grabbing = useComputed(() => pointerTarget.value !== null).value;
  const over = state.hovered.value !== null && !state.standalone.value;
  return (
    <div class="stage" data-unsure={state.unsure.value || shown.value.what === "between"} data-cursor={grabbing ? "grabbing" : spaceHeld.value ? "grab" : measuring.value || lassoing.value ? "cell" : state.gluing.value ? "cell" : over ? "grab" : "default"}>
      <canvas
        ref={canvas} tabIndex={0} role="application" aria-roledescription="drawing"
        aria-label={`${parts} parts, gap ${design.value.gap} mm. Full stop and comma choose a part${state.standalone.value ? "" : ", arrow keys move it or turn its pull"}, question mark lists all keys.`}
      />
      <Overlay />
    </div>
  );
}
