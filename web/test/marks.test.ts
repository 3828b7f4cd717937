/** Which contacts are marked where there are too many for a picture. */

import assert from "node:assert/strict";
import { test } from "node:test";
import type { ContactEntry } from "../src/protocol.ts";
import { mostMarks, strongest } from "../src/stage/marks.ts";

const spot = (force: number, x: number, y = 5) => ({ contact: { force } as ContactEntry, x, y });
const forces = (some: ReturnType<typeof strongest>): number[] => some.map(({ contact }) => contact.force);

test("of many contacts the strongest in view are marked", () => {
  const all = [spot(1, 10), spot(9, 200), spot(3, 20), spot(2, 30), spot(4, 40, -1)];
  assert.deepEqual(forces(strongest(all, { width: 100, height: 50 }, 2)), [3, 2]);
});

test("coming nearer marks weaker ones, too", () => {
  assert.deepEqual(forces(strongest([spot(1, 10), spot(9, 200)], { width: 100, height: 50 }, 1)), [1]);
});

test("a small picture has few marks, a large one no more than can be told apart", () => {
  assert.ok(mostMarks({ width: 390, height: 110 }) < 15);
  assert.equal(mostMarks({ width: 4000, height: 4000 }), mostMarks({ width: 2000, height: 2000 }));
});
