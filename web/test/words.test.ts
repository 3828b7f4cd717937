import assert from "node:assert/strict";
import { test } from "node:test";
import { relative } from "../src/panels/relative.ts";
import type { PartShape, Point } from "../src/protocol.ts";
import { nearestBy, places, short, ticks } from "../src/words.ts";

test("long names are cut between signs, not within one", () => {
  assert.equal(short("board"), "board");
  assert.equal(short("🧩".repeat(24)), "🧩".repeat(24));
  assert.equal(short(`a${"🧩".repeat(30)}`, 10), `a${"🧩".repeat(3)}…${"🧩".repeat(5)}`);
});

test("decimals show four digits of the largest number", () => {
  assert.equal(places([0.5, -12.34]), 2);
  assert.equal(places([0.0012, 0.5]), 4);
  assert.equal(places([1, 2, 300]), 0);
  assert.equal(places([Infinity, NaN]), 0);
});

test("the nearest of some things", () => {
  assert.equal(nearestBy([1, 2, 5], (v) => v, 3.4), 2);
  assert.equal(nearestBy([], (v: number) => v, 1), undefined);
});

const near = (a: readonly number[], b: readonly number[]): void => a.forEach((v, i) => assert.ok(Math.abs(v - b[i]!) < 1e-5, `${a} is not ${b}`));
const part = (name: string, x: number, y: number, degrees: number): PartShape => ({ name, at: [x, y, degrees], rings: [] });

test("a pair is seen in the axes of its first part, at the pivot", () => {
  const parts = [part("a", 3, -2, 90), part("b", 7, 5, 20)];
  const at = (motion: number[], pivot: Point) => relative(parts, "a", "b", new Float32Array(motion), pivot);
  near(at([0, 0, 0, 0.3, 0, 0], [1, 2]), [0, -0.3, 0]); // +x of the world is -y of a part that is turned by 90 degrees
  // b turns about its pivot: from b's reference point (1, 2) in a's axes, which is (-2, 1) in the world's
  const [c, s] = [Math.cos(0.4), Math.sin(0.4)];
  const fixed = [-2 - (c * -2 - s * 1), 1 - (s * -2 + c * 1)];
  near(at([0, 0, 0, fixed[0]!, fixed[1]!, 0.4], [1, 2]), [0, 0, (0.4 * 180) / Math.PI]);
  // both go as one: a turns about its reference point, b round it
  const [dx, dy] = [4, 7];
  near(at([0.5, 0.1, 0.4, 0.5 + c * dx - s * dy - dx, 0.1 + s * dx + c * dy - dy, 0.4], [1, 2]), [0, 0, 0]);
});

test("ticks are round and inside", () => {
  assert.deepEqual(ticks(0, 1, 5), [0, 0.2, 0.4, 0.6, 0.8, 1]);
  assert.deepEqual(ticks(0, 24.2, 3), [0, 10, 20]);
  assert.deepEqual(ticks(0.3, 0.3, 3), [0.3]);
});
