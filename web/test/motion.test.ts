import assert from "node:assert/strict";
import { test } from "node:test";
import { along, between, fittingFactor, reach, valueBetween } from "../src/motion.ts";

const frames = { k: 3, n: 1, data: new Float32Array([0, 0, 0, 2, 4, 1, 4, 4, 1]) };

test("a path is followed linearly between its frames, and stays at its ends", () => {
  const out = new Float32Array(3);
  assert.deepEqual([...along(frames, 0.25, out)], [1, 2, 0.5]);
  assert.deepEqual([...along(frames, 0.75, out)], [3, 4, 1]);
  assert.deepEqual([...along(frames, 7, out)], [4, 4, 1]);
  assert.deepEqual([...along({ k: 1, n: 1, data: new Float32Array([5, 6, 7]) }, 0.3, out)], [5, 6, 7]);
});

test("between solved gaps the motion is linear; beyond them nothing is known", () => {
  const solved = [1, 3].map((gap) => ({ gap, objective: gap * 10, end: new Float32Array([gap, 2 * gap, 0]) }));
  solved.splice(1, 0, { gap: 2, objective: 26, end: new Float32Array([4, 4, 0]) });
  assert.deepEqual([...between(solved, 1.5)!], [2.5, 3, 0]);
  assert.deepEqual([...between(solved, 3)!], [3, 6, 0]);
  assert.equal(between(solved, 0.5), null);
  assert.equal(between(solved, 6), null);
  assert.equal(valueBetween(solved, 2.5), 28);
  assert.equal(valueBetween(solved, 0.5), null);
  assert.equal(valueBetween(solved, 1e9), null);
  assert.equal(between([], 1), null);
});

test("gaps at which everything comes free have no motion to go between", () => {
  const solved = [{ gap: 1, objective: 10, end: new Float32Array([1, 0, 0]) }, { gap: 2, objective: null, end: null }];
  assert.equal(between(solved, 1.5), null);
  assert.equal(valueBetween(solved, 1.5), null);
  assert.deepEqual([...between(solved, 1)!], [1, 0, 0]);
});

test("small motions are enlarged by a round factor that stays while it serves", () => {
  assert.equal(reach(frames, [0]), Math.hypot(4, 4));
  assert.equal(reach(frames, [2]), Math.hypot(4, 4) + 2);
  assert.equal(fittingFactor(10, 100), 1);
  assert.equal(fittingFactor(0.5, 100), 20);
  assert.equal(fittingFactor(0.6, 100, 20), 20);
  assert.equal(fittingFactor(0, 100), 1);
  assert.equal(fittingFactor(1e-3, 100), 1); // no factor makes it seen
  assert.equal(fittingFactor(1e-3, 100, 100), 1);
  assert.equal(fittingFactor(0.01, 100), 100);
});
