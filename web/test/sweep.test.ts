import assert from "node:assert/strict";
import { test } from "node:test";
import { outlineOf } from "../src/collision/outline.ts";
import { type Body, firstContact, slideTowards } from "../src/collision/sweep.ts";
import type { Ring } from "../src/protocol.ts";

const CLEARANCE = 1e-6;
const box = (w: number, h: number): Ring => [[-w / 2, -h / 2], [w / 2, -h / 2], [w / 2, h / 2], [-w / 2, h / 2]];
const at = (rings: Ring[], x: number, y: number, turn = 0): Body => ({ outline: outlineOf(rings), x, y, cos: Math.cos(turn), sin: Math.sin(turn) });
const near = (a: readonly number[], b: readonly number[], tolerance = 1e-5): void => a.forEach((v, i) => assert.ok(Math.abs(v - b[i]!) <= tolerance, `${a} is not ${b}`));

const frame = at([box(30, 30), box(12, 12)], 0, 0);
const peg = at([box(10, 10)], 0, 0);

test("a peg in a frame goes to the wall and then along it into the corner, whichever way rings turn", () => {
  for (const hole of [box(12, 12), [...box(12, 12)].reverse()]) {
    const around = at([box(30, 30), hole], 0, 0);
    near(slideTowards([peg], [around], [0.5, 0.2], CLEARANCE), [0.5, 0.2]);
    near(slideTowards([peg], [around], [7, 0.4], CLEARANCE), [1, 0.4]);
    near(slideTowards([peg], [around], [7, -9], CLEARANCE), [1, -1]);
  }
});

test("what is thin is not passed through at any speed", () => {
  const wall = at([box(1e-3, 40)], 20, 0);
  near(slideTowards([peg], [wall], [1e6, 0], CLEARANCE), [15 - 5e-4, 0]);
  const tip = at([[[20, 0], [60, -1e-3], [60, 1e-3]]], 0, 0); // a needle that meets an edge of the peg, not a corner
  near([firstContact([peg], [tip], 0, 0, 100, 0, CLEARANCE).share * 100], [15], 1e-4);
});

test("parts that touch may slide along each other and leave, but not go deeper", () => {
  const floor = at([box(100, 10)], 0, -10);
  near(slideTowards([peg], [floor], [3, 0], CLEARANCE), [3, 0]);
  near(slideTowards([peg], [floor], [3, -2], CLEARANCE), [3, 0], 1e-4);
  near(slideTowards([peg], [floor], [1, 2], CLEARANCE), [1, 2]);
});

test("bodies that lie turned, and several that move as one", () => {
  const turned = at([box(30, 30), box(12, 12)], 0, 0, Math.PI / 6);
  const held = at([box(10, 10)], 0, 0, Math.PI / 6);
  const [x, y] = slideTowards([held], [turned], [5 * Math.cos(Math.PI / 6), 5 * Math.sin(Math.PI / 6)], CLEARANCE);
  near([Math.hypot(x, y)], [1]);
  near(slideTowards([at([box(2, 2)], 40, 0), peg], [frame], [9, 0], CLEARANCE), [1, 0]);
});

test("no shift overlaps, in random scenes, by points of the one in the other", () => {
  let seed = 7;
  const random = (): number => ((seed = (seed * 16807) % 2147483647) / 2147483647);
  const star = (n: number): Ring => Array.from({ length: n }, (_, k) => {
    const [r, a] = [2 + 6 * random(), ((k + 0.7 * random()) * 2 * Math.PI) / n];
    return [r * Math.cos(a), r * Math.sin(a)];
  });
  const inside = (ring: Ring, px: number, py: number): boolean => ring.reduce((odd, [x, y], k) => {
    const [ox, oy] = ring[(k + ring.length - 1) % ring.length]!;
    return y > py !== oy > py && px < ((ox - x) * (py - y)) / (oy - y) + x ? !odd : odd;
  }, false);
  let moved = 0;
  for (let k = 0; k < 200; k++) {
    const [mine, other] = [star(5 + (k % 9)), star(4 + (k % 7))];
    const turn = 6 * random();
    const [a, b] = [at([mine], 0, 0), at([other], 17, 17 * (random() - 0.5), turn)];
    const desired: [number, number] = [40 * random(), 30 * (random() - 0.5)];
    const [x, y] = slideTowards([a], [b], desired, CLEARANCE);
    moved += Math.hypot(x, y) > 0.1 ? 1 : 0;
    for (let i = 0; i < 4000; i++) {
      const [px, py] = [x + 8 * (2 * random() - 1), y + 8 * (2 * random() - 1)];
      const [dx, dy] = [px - b.x, py - b.y];
      const there = inside(other, b.cos * dx + b.sin * dy, -b.sin * dx + b.cos * dy);
      assert.ok(!(there && inside(mine, px - x, py - y)), `scene ${k} overlaps`);
    }
  }
  assert.ok(moved > 190);
});
