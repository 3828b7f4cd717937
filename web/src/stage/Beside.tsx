/** The kept answer in a canvas of its own, beside the live one: the same view, the same place on the path, the same magnification. */

import { effect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { Button } from "../chrome/Button.tsx";
import { along, end, factor, place } from "../motion.ts";
import type { Point } from "../protocol.ts";
import { indexOf, names } from "../state.ts";
import { panBy, pointIn, size, view, zoomByWheel } from "./camera.ts";
import { colours } from "./colours.ts";
import { difference, type Kept, kept, swap } from "./kept.ts";
import { paintMarks } from "./marks.ts";
import { clear, paint } from "./paint.ts";

const NONE: ReadonlySet<number> = new Set();

/** Paints whenever something that it shows changes. */
function painter(canvas: HTMLCanvasElement): () => void {
  const g = canvas.getContext("2d", { alpha: false })!;
  let wanted = 0;
  const draw = (): void => {
    wanted = 0;
    const one = kept.peek();
    if (one && size.peek().width) paintKept(g, one);
  };
  const stop = effect(() => {
    void [kept.value, view.value, size.value, place.value, factor(), colours()];
    if (!wanted) wanted = requestAnimationFrame(draw);
  });
  return () => {
    stop();
    cancelAnimationFrame(wanted);
  };
}

function paintKept(g: CanvasRenderingContext2D, { about, shapes, roles }: Kept): void {
  const ratio = g.canvas.width / size.peek().width;
  const path = about.paths[0]!;
  const at = place.peek();
  const motion = along(path, at);
  const scene = {
    shapes, names: names.peek(), roles, blame: null, motion, of: "answer", factor: factor(), chosen: NONE, hovered: -1, held: NONE, colours: colours(),
  };
  clear(g, scene.colours);
  paint(g, size.peek(), ratio, view.peek(), scene, false);
  if (at < 0.999) return;
  const marks = { contacts: about.reply.contacts, at: end(path), thread: null, highlit: null };
  paintMarks(g, size.peek(), ratio, view.peek(), scene.colours, shapes, indexOf.peek(), motion, scene.factor, marks);
}

export function Beside() {
  return kept.value && <Pane of={kept.value} />;
}

function Pane({ of }: { of: Kept }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const own = canvas.current!;
    const stop = painter(own);
    const gone = new AbortController();
    const { signal } = gone;
    let held: Point | null = null;
    own.addEventListener("pointerdown", (event) => {
      own.setPointerCapture(event.pointerId);
      held = pointIn(own, event);
    }, { signal });
    own.addEventListener("pointermove", (event) => {
      if (!held) return;
      const at = pointIn(own, event);
      panBy(at[0] - held[0], at[1] - held[1]);
      held = at;
    }, { signal });
    for (const kind of ["pointerup", "pointercancel"] as const) own.addEventListener(kind, () => (held = null), { signal });
    own.addEventListener("wheel", (event) => zoomByWheel(own, event), { passive: false, signal });
    const watch = new ResizeObserver(([entry]) => {
      const ratio = window.devicePixelRatio || 1;
      const { width, height } = entry!.contentRect;
      own.width = Math.round(width * ratio);
      own.height = Math.round(height * ratio);
      if (kept.peek()) paintKept(own.getContext("2d", { alpha: false })!, kept.peek()!);
    });
    watch.observe(own);
    return () => {
      stop();
      gone.abort();
      watch.disconnect();
    };
  }, []);
  const { reply, design } = of.about;
  return (
    <section class="beside" aria-label="kept answer">
      <div class="label">
        <p class="answer">kept: {reply.headline}</p>
        <p class="facts">gap {design.gap} mm · {reply.facts[0]}</p>
        <p class="difference" role="status">{difference()}</p>
        <span class="buttons">
          <Button label="Go to the kept design and keep this one" onClick={swap}>Swap</Button>
          <Button icon="close" label="Keep nothing beside" onClick={() => (kept.value = null)} />
        </span>
      </div>
      <div class="pane"><canvas ref={canvas} aria-label={`Kept: ${reply.headline}, gap ${design.gap} mm`} role="img" /></div>
    </section>
  );
}
