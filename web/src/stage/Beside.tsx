/** The kept answer in a picture of its own, beside the live one: the same place on the path, the same magnification. */

import { effect, signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { Button } from "../chrome/Button.tsx";
import { change } from "../design.ts";
import { along, end, factor, place, sampled } from "../motion.ts";
import type { Point } from "../protocol.ts";
import { swapKept } from "../session.ts";
import { drawing, section } from "../state.ts";
import type { Eye, SolidView } from "../stage3d.ts";
import { panBy, pointIn, solidEye, solidView, view, wheelFactor, zoomBy } from "./camera.ts";
import { colours, isDark } from "./colours.ts";
import { differences, type Kept, kept, linked, ofThisFile, sameQuestionFits } from "./kept.ts";
import { paintMarks } from "./marks.ts";
import { clear, paint } from "./paint.ts";
import { around } from "./shapes.ts";
import { AXES, opener } from "./SolidStage.tsx";
import { fit, panned, type Size, type View, zoomed } from "./view.ts";

const NONE: ReadonlySet<number> = new Set();
const INSET = { top: 22, right: 24, bottom: 24, left: 24 };
/** So many places of a film are looked at to fit it, and parts that leave are followed so many times the drawing's longer side. */
const MOST_SEEN = 24;
const MOST_FAR = 2;

/** What the kept picture shows while it is moved alone. */
const own = signal<View>({ x: 0, y: 0, scale: 1 });

/** The view of the live picture: of another file about the middle of that one, at the same scale. */
function shared({ opened }: Kept): View {
  if (ofThisFile.value) return view.value;
  const [[x0, y0, x1, y1], [u0, v0, u1, v1]] = [opened.size, drawing.value!.size];
  return { x: view.value.x + (x0 + x1 - u0 - u1) / 2, y: view.value.y + (y0 + y1 - v0 - v1) / 2, scale: view.value.scale };
}

function fitOwn(one: Kept, size: Size): void {
  own.value = fit(around(one.shapes, one.opened.size, sampled(one.about.paths[0]!, MOST_SEEN), factor(), MOST_FAR), size, INSET);
}

function paintKept(g: CanvasRenderingContext2D, size: Size, { about, opened, shapes, roles }: Kept, seen: View): void {
  const ratio = g.canvas.width / size.width;
  const path = about.paths[0]!;
  const at = place.peek();
  const motion = along(path, at);
  const names = opened.parts.map((part) => part.name);
  const scene = {
    shapes, names, roles, blame: null, motion, of: "answer", factor: factor(), chosen: NONE, hovered: -1, held: NONE, colours: colours(),
  };
  clear(g, scene.colours);
  paint(g, size, ratio, seen, scene, false);
  if (at < 0.999) return;
  const marks = { contacts: about.reply.contacts, at: end(path), thread: null, highlit: null };
  paintMarks(g, size, ratio, seen, scene.colours, shapes, new Map(names.map((name, i) => [name, i])), motion, scene.factor, marks);
}

/** The kept parts of a drawing, in a canvas that the pointer moves. */
function FlatPane({ of }: { of: Kept }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const here = canvas.current!;
    const g = here.getContext("2d", { alpha: false })!;
    const size = signal<Size>({ width: 0, height: 0 });
    let wanted = 0;
    const stopFit = effect(() => {
      if (!linked.value && size.value.width) fitOwn(of, size.value);
    });
    const stop = effect(() => {
      const seen = linked.value ? shared(of) : own.value;
      void [size.value, place.value, factor(), colours()];
      cancelAnimationFrame(wanted);
      wanted = requestAnimationFrame(() => {
        if (size.peek().width) paintKept(g, size.peek(), of, seen);
        here.dataset.view = JSON.stringify([seen.x, seen.y, seen.scale]);
      });
    });
    const gone = new AbortController();
    const { signal: ended } = gone;
    let held: Point | null = null;
    here.addEventListener("pointerdown", (event) => {
      here.setPointerCapture(event.pointerId);
      held = pointIn(here, event);
    }, { signal: ended });
    here.addEventListener("pointermove", (event) => {
      if (!held) return;
      const at = pointIn(here, event);
      const [dx, dy] = [at[0] - held[0], at[1] - held[1]];
      if (linked.peek()) panBy(dx, dy);
      else own.value = panned(own.peek(), dx, dy);
      held = at;
    }, { signal: ended });
    for (const kind of ["pointerup", "pointercancel"] as const) here.addEventListener(kind, () => (held = null), { signal: ended });
    here.addEventListener("wheel", (event) => {
      event.preventDefault();
      if (linked.peek()) zoomBy(wheelFactor(event), pointIn(here, event));
      else own.value = zoomed(own.peek(), size.peek(), pointIn(here, event), wheelFactor(event));
    }, { passive: false, signal: ended });
    here.addEventListener("dblclick", () => !linked.peek() && fitOwn(of, size.peek()), { signal: ended });
    const watch = new ResizeObserver(([entry]) => {
      const ratio = window.devicePixelRatio || 1;
      const { width, height } = entry!.contentRect;
      here.width = Math.round(width * ratio);
      here.height = Math.round(height * ratio);
      size.value = { width, height };
    });
    watch.observe(here);
    return () => {
      cancelAnimationFrame(wanted);
      stopFit();
      stop();
      gone.abort();
      watch.disconnect();
    };
  }, [of]);
  return <div class="pane"><canvas ref={canvas} aria-label={labelOf(of)} role="img" /></div>;
}

/** The kept parts in space; the pointer turns them. */
function SolidPane({ of }: { of: Kept }) {
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => {
    let leave: (() => void) | null = null;
    let gone = false;
    opener().then((open) => {
      if (!gone && box.current) leave = shownIn(box.current, open, of);
    }, () => undefined); // the live picture says why there is none
    return () => {
      gone = true;
      leave?.();
    };
  }, [of]);
  return <div class="pane stage solid" ref={box} />;
}

function shownIn(box: HTMLElement, open: (typeof globalThis & { openStage: typeof import("../stage3d.ts").openStage })["openStage"], { about, opened, solids, roles }: Kept): () => void {
  const path = about.paths[0]!;
  const nothing = (): void => undefined;
  const solid: SolidView = open(box, labelOf({ about, opened }), {
    pose: () => ({ motion: along(path, place.peek()), moving: false }),
    end: () => end(path),
    film: () => sampled(path, MOST_SEEN),
    factor: () => factor(),
    exploded: () => 0,
    section: () => section.peek(),
    marks: () => ({ contacts: place.peek() < 0.999 ? [] : about.reply.contacts, goals: typeof about.design.goals === "string" ? [] : about.design.goals, highlit: null }),
    free: () => false,
    hover: nothing, choose: nothing, joint: nothing, menu: nothing, drag: nothing, release: nothing,
    seen: (eye) => together() && !sameEye(eye, solidEye.peek()) && solidView.peek()?.see(eye),
  });
  if (solids) solid.solids(solids);
  const stops = [
    effect(() => {
      const row = colours();
      const { force, motion, pulled } = row;
      const looks = opened.parts.map(({ name }, i) => ({ name, fill: row[roles[i]!][0], edge: row[roles[i]!][1], see: false }));
      solid.looks(looks, { force, motion, ghost: pulled[1], axes: AXES[isDark() ? "dark" : "light"] });
    }),
    effect(() => {
      void [place.value, factor(), section.value];
      solid.ask();
    }),
    effect(() => {
      if (together() && solidEye.value) solid.see(solidEye.value);
    }),
  ];
  return () => {
    for (const stop of stops) stop();
    solid.remove();
  };
}

/** Whether both pictures are of parts in space, and seen from one place. */
const together = (): boolean => linked.value && drawing.value!.dimension === 3;
const sameEye = (one: Eye, other: Eye | null): boolean => other !== null && [...one.at, ...one.target].every((v, k) => Math.abs(v - [...other.at, ...other.target][k]!) <= 1e-6 * Math.hypot(...one.at));

const labelOf = ({ about, opened }: Pick<Kept, "about" | "opened">): string => `Kept: ${about.reply.headline}, ${opened.name}, gap ${about.design.gap} mm`;

export function Beside() {
  return kept.value && <Pane of={kept.value} />;
}

function Pane({ of }: { of: Kept }) {
  const { reply, design } = of.about;
  const alike = of.opened.dimension === drawing.value!.dimension;
  const here = ofThisFile.value;
  const fits = sameQuestionFits();
  return (
    <section class="beside" aria-label="kept answer">
      <div class="label">
        <div class="said">
          <p class="answer">kept: {reply.headline}</p>
          <p class="facts">{here ? "" : `${of.opened.name} · `}gap {design.gap} mm · {reply.facts[0]}</p>
          <span class="buttons">
            {alike && <Button label={linked.value ? "Move each picture alone" : "Move both pictures together, at one scale"} pressed={linked.value} onClick={() => (linked.value = !linked.peek())} class="small">Linked</Button>}
            {!here && <Button label={fits ? "Ask the same of the file that is open: gap, fixed parts and pulls as kept" : "The file that is open lacks parts that the kept question names"} disabled={!fits} onClick={() => change(design)} class="small">Ask the same</Button>}
            <Button label="Go to the kept design and keep this one" onClick={swapKept} class="small">Swap</Button>
            <Button icon="close" label="Keep nothing beside" onClick={() => (kept.value = null)} class="small" />
          </span>
        </div>
        <div class="difference" role="status"><Differences /></div>
      </div>
      {of.opened.dimension === 2 ? <FlatPane of={of} /> : <SolidPane of={of} />}
    </section>
  );
}

function Differences() {
  const rows = differences();
  if (!rows.length) return null;
  return (
    <table>
      <thead><tr><td /><th scope="col">kept</th><th scope="col">now</th></tr></thead>
      <tbody>{rows.map(([what, was, is]) => <tr key={what}><th scope="row">{what}</th><td>{was}</td><td>{is}</td></tr>)}</tbody>
    </table>
  );
}
