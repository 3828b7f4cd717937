import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import type { Scene } from "../src/stage/paint.ts";
import { type Picture, Retained, UNSEEN } from "../src/stage/retained.ts";

/** A canvas that counts how often its state was saved and not restored, and the parts that were filled. */
class Canvas {
  width = 800;
  height = 600;
  saved = 0;
  canvas = this;
  getContext = (): Canvas => this;
  save(): void { this.saved++; }
  restore(): void { this.saved--; }
  setTransform(): void {}
  beginPath(): void {}
  rect(): void {}
  clip(): void {}
  fill(): void { drawn++; }
  stroke(): void { drawn++; }
  fillRect(): void {}
  fillText(): void {}
  drawImage(): void {}
}

let drawn = 0;
const made: Canvas[] = [];
const PARTS = 400;
const NONE: ReadonlySet<number> = new Set();
const [path, colours] = [{} as Path2D, { neutral: ["", ""] } as unknown as Scene["colours"]];
const shapes: Scene["shapes"] = Array.from({ length: PARTS }, (_, i) => ({ path, rings: [], at: [20 * (i % 20), 20 * Math.floor(i / 20)], radius: 8, name: { at: [0, 0], room: 0 }, width: 16 }));
const roles = shapes.map((): "neutral" => "neutral");
const names = shapes.map((_, i) => `p${i}`);
const [size, view] = [{ width: 800, height: 600 }, { x: 200, y: 200, scale: 1 }];
const screen = new Canvas() as unknown as CanvasRenderingContext2D;

/** All parts moved to the right. */
function picture(right: number, seen = view): Picture {
  const motion = new Float32Array(3 * PARTS).map((_, k) => (k % 3 ? 0 : right));
  return { size, ratio: 1, view: seen, scene: { shapes, names, roles, blame: null, motion, of: String(right), factor: 1, chosen: NONE, hovered: -1, held: NONE, colours } };
}

beforeEach(() => {
  made.length = 0;
  (globalThis as Record<string, unknown>)["document"] = { createElement: () => made[made.push(new Canvas()) - 1] };
});

test("what is wanted last is shown at last, though it came while something older was painted in shares", () => {
  const retained = new Retained();
  retained.show(screen, picture(0), 0, 5);
  assert.equal(retained.show(screen, picture(1), UNSEEN, 0).motion[0], 0);
  assert.ok(retained.behind);
  let [shown, frames] = [0, 0];
  for (const last = picture(1.1); retained.behind && frames < PARTS; frames++) shown = retained.show(screen, last, 0, 0).motion[0]!;
  assert.ok(Math.abs(shown - 1.1) < 1e-6, `${shown} after ${frames} frames`);
});

test("answers that come sooner than they are painted are shown all the same, each under its own name", () => {
  const retained = new Retained();
  retained.show(screen, picture(0), 0, 5);
  const seen = new Set<string>();
  for (let wanted = 1; wanted < 2 * PARTS; wanted++) {
    const { of, motion } = retained.show(screen, picture(wanted), UNSEEN, 0);
    assert.equal(motion[0], Number(of));
    assert.ok(retained.behind);
    seen.add(of);
  }
  assert.ok(seen.size > 10, `${seen.size} answers`);
});

test("what was painted in shares and is wanted still is no longer behind in the frame that shows it", () => {
  const retained = new Retained();
  retained.show(screen, picture(0), 0, 5);
  let [shown, frames] = [0, 0];
  for (; shown === 0 && frames < 10 * PARTS; frames++) shown = retained.show(screen, picture(1), UNSEEN, 0).motion[0]!;
  assert.ok(frames > 2, "several shares");
  assert.ok(!retained.behind);
});

test("a picture given up while it was painted leaves no region behind to which the next one is cut", () => {
  const retained = new Retained();
  retained.show(screen, picture(0), 0, 5);
  retained.show(screen, picture(1), UNSEEN, 0);
  retained.show(screen, picture(1, { ...view, scale: 2 }), UNSEEN, 0);
  assert.ok(!retained.behind);
  assert.deepEqual(made.map(({ saved }) => saved), [0, 0]);
});

test("after slow frames the share of a quick frame is soon as large as before", () => {
  const retained = new Retained();
  const framesFor = (to: number, took: number): number => {
    let frames = 0;
    do {
      retained.show(screen, picture(to), 0, 12);
      retained.tune(took);
      frames++;
    } while (retained.behind && frames < 10 * PARTS);
    return frames;
  };
  retained.show(screen, picture(0), 0, 5);
  for (let k = 1; k < 60; k++) framesFor(k % 2, 100);
  assert.ok(framesFor(0.5, 5) + framesFor(0, 5) < 40);
});

test("outlines at rest count for the share of a frame as parts do", () => {
  const retained = new Retained();
  retained.show(screen, picture(0), 0, 5);
  const mostSteps = 25 / 0.05; // of the first estimate for one step
  drawn = 0;
  retained.show(screen, picture(1), 0, 25);
  assert.ok(retained.behind, "800 steps are no work for one frame");
  assert.ok(drawn <= 2 * mostSteps, `${drawn} lines and areas`); // a part has both
});
