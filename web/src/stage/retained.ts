/**
 * The picture of the parts as a bitmap that is kept from frame to frame: only what has changed is painted anew.
 *
 * Where that is little, the region round it is painted in one frame. Where it is much, a second bitmap is painted over several frames while
 * the first one stays, each with so many parts as its share of a frame holds: the part under the hand, which is painted over the bitmap, waits
 * for none of them, and what is shown is always one motion of all.
 */

import type { Point } from "../protocol.ts";
import { changed, clear, extentOf, painting, type Region, type Scene, stepsIn } from "./paint.ts";
import { placed } from "./shapes.ts";
import { type Size, toScreen, type View } from "./view.ts";

/** Parts that moved by less than this [px] are left while the hand moves; when it rests everything is exact. */
export const UNSEEN = 0.25;
/** Time for the bitmap in one frame [ms] while the hand moves, less than a third of the 16.7 ms of most screens, and while it rests. */
export const SHARE = { moving: 5, resting: 12 };
/** So many parts are painted in one frame at least. */
const MIN_PARTS = 50;
/** Time for one part at first [ms]; it follows what painting took. */
const FIRST_TIME = 0.05;
/** A frame longer than this [ms] held too many parts, wherever the time went: a graphics processor works them off later. */
const SLOW = 30;
/** By how much the time for one part may change from frame to frame, and how long it is at most [ms]: more would change no frame. */
const FALL = 0.67;
const RISE = 2;
const LONGEST = SHARE.resting / MIN_PARTS;

/** What is to be seen on a canvas. */
export interface Picture { size: Size; ratio: number; view: View; scene: Scene }

/** What a bitmap shows; `painted` differs from the motion of the scene by what cannot be seen. */
interface Bitmap { g: CanvasRenderingContext2D; picture: Picture | null; painted: Float32Array }

export class Retained {
  #front = bitmap();
  #back: Bitmap | null = null;
  #steps: Generator<void, void> | null = null;
  /** Time for one part [ms]. */
  #each = FIRST_TIME;
  /** So many were painted in the present frame. */
  #painted = 0;
  #behind = false;

  /** True while the bitmap may show an older motion than the last one that it was given: it has to be shown again. */
  get behind(): boolean {
    return this.#behind;
  }

  /** After a frame that took so long [ms]. */
  tune(took: number): void {
    if (took > SLOW && this.#painted > 0) this.#learn(this.#each * RISE);
  }

  /** Puts the parts onto a canvas, those under the hand left out, in a share of a frame [ms], and gives the scene that it shows; parts moved by less than `least` [px] stay. */
  show(g: CanvasRenderingContext2D, wanted: Picture, least: number, share: number): Scene {
    const now = { ...wanted, scene: { ...wanted.scene, motion: wanted.scene.motion.slice() } };
    const most = Math.max(share / this.#each, MIN_PARTS);
    const began = performance.now();
    let older = false;
    this.#painted = 0;
    if (resized(this.#front, g.canvas) || !this.#front.picture || !alike(this.#front.picture, now)) {
      this.#steps?.return();
      this.#steps = null;
      for (const _ of repainting(this.#front, now)) void _;
    } else if (!this.#steps) {
      const change = damage(this.#front, now, least);
      if (!change) this.#front.picture = now;
      else if (stepsIn(now.size, now.view, now.scene, change.region) <= most) for (const _ of repainting(this.#front, now, change)) this.#painted++;
      else this.#begin(g.canvas, now, change);
    } else older = true; // what is painted was wanted in an earlier frame
    if (this.#steps) this.#goOn(g, most);
    if (older && !this.#steps && alike(this.#front.picture!, now) && !damage(this.#front, now, least)) { // and is wanted still
      this.#front.picture = now;
      older = false;
    }
    this.#behind = older || this.#steps !== null;
    g.setTransform(1, 0, 0, 1, 0, 0);
    g.drawImage(this.#front.g.canvas, 0, 0);
    if (this.#painted >= MIN_PARTS) this.#learn((performance.now() - began) / this.#painted);
    return this.#front.picture!.scene;
  }

  #learn(each: number): void {
    this.#each = Math.min(Math.max(each, this.#each * FALL), this.#each * RISE, LONGEST);
  }

  #begin(canvas: HTMLCanvasElement, now: Picture, change: Damage): void {
    const back = (this.#back ??= bitmap());
    resized(back, canvas);
    back.g.setTransform(1, 0, 0, 1, 0, 0);
    back.g.drawImage(this.#front.g.canvas, 0, 0);
    back.painted = this.#front.painted;
    this.#steps = repainting(back, now, change);
  }

  #goOn(g: CanvasRenderingContext2D, most: number): void {
    while (this.#painted < most) {
      if (this.#steps!.next().done) {
        [this.#front, this.#back, this.#steps] = [this.#back!, this.#front, null];
        return;
      }
      this.#painted++;
    }
    g.setTransform(1, 0, 0, 1, 0, 0);
    g.drawImage(this.#back!.g.canvas, 0, 0, 1, 1, 0, 0, 1, 1); // what was drawn is worked off now, not all at the end
  }
}

const bitmap = (): Bitmap => ({ g: document.createElement("canvas").getContext("2d", { alpha: false })!, picture: null, painted: new Float32Array(0) });

/** Gives a bitmap the size of a canvas; true where it had another. */
function resized({ g }: Bitmap, { width, height }: HTMLCanvasElement): boolean {
  if (g.canvas.width === width && g.canvas.height === height) return false;
  [g.canvas.width, g.canvas.height] = [width, height];
  return true;
}

/** Paints a picture, or of it what has changed, and notes what is to be seen then. */
function* repainting(onto: Bitmap, now: Picture, change?: Damage): Generator<void, void> {
  const { g } = onto;
  const { size, ratio, view, scene } = now;
  let { motion } = scene;
  g.save();
  if (change) {
    const [x0, y0, x1, y1] = change.region;
    g.setTransform(1, 0, 0, 1, 0, 0);
    g.beginPath();
    g.rect(Math.floor(x0 * ratio), Math.floor(y0 * ratio), Math.ceil((x1 - x0) * ratio) + 1, Math.ceil((y1 - y0) * ratio) + 1);
    g.clip();
    motion = onto.painted.slice();
    for (const i of change.parts) motion.set(scene.motion.subarray(3 * i, 3 * i + 3), 3 * i);
  }
  clear(g, scene.colours);
  try {
    yield* painting(g, size, ratio, view, { ...scene, motion }, false, change?.region);
  } finally { // given up, too: the region is not to stay for what is painted next
    g.restore();
  }
  onto.painted = motion;
  onto.picture = now;
}

/** Whether two pictures differ in no more than parts may. */
function alike(a: Picture, b: Picture): boolean {
  const same = a.view === b.view && a.size === b.size && a.ratio === b.ratio && a.scene.factor === b.scene.factor;
  return same && a.scene.shapes === b.scene.shapes && a.scene.colours === b.scene.colours;
}

/** Parts that look or lie otherwise than they were painted, and the region round them [px]. */
interface Damage { parts: readonly number[]; region: Region }

function damage({ picture, painted }: Bitmap, now: Picture, least: number): Damage | null {
  const { scene: before } = picture!;
  const { scene, view, size } = now;
  const parts: number[] = [];
  let [x0, y0, x1, y1] = [size.width, size.height, 0, 0];
  scene.shapes.forEach((shape, i) => {
    if (changed(shape, painted, scene.motion, i) * scene.factor * view.scale <= least && looksAlike(before, scene, i)) return;
    parts.push(i);
    const far = extentOf(view, shape.radius);
    const places: Point[] = [painted, scene.motion].map((motion) => {
      const { x, y } = placed(shape, motion, i, scene.factor);
      return [x, y];
    });
    for (const [x, y] of [...places, shape.at].map((at) => toScreen(view, size, at))) {
      [x0, y0, x1, y1] = [Math.min(x0, x - far), Math.min(y0, y - far), Math.max(x1, x + far), Math.max(y1, y + far)];
    }
  });
  if (!parts.length) return null;
  return { parts, region: [Math.max(x0, 0), Math.max(y0, 0), Math.min(x1, size.width), Math.min(y1, size.height)] };
}

/** Whether a part looks alike in two scenes: what may change while the hand moves. */
function looksAlike(a: Scene, b: Scene, i: number): boolean {
  return a.roles[i] === b.roles[i] && a.blame?.[i] === b.blame?.[i] && a.chosen.has(i) === b.chosen.has(i)
    && (a.hovered === i) === (b.hovered === i) && a.held.has(i) === b.held.has(i);
}
