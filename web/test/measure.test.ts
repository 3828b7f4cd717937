import assert from "node:assert/strict";
import { test } from "node:test";
import { long, shortest } from "../src/stage/measure.ts";

test("the clearance of two edges is that of their nearest points", () => {
  assert.equal(long(shortest([[0, 0], [10, 0]], [[2, 3], [8, 3]])), 3);
  assert.equal(long(shortest([[0, 0], [10, 0]], [[13, 4], [20, 4]])), 5);
  assert.deepEqual(shortest([[0, 0], [10, 0]], [[4, 2], [4, 7]]), [[4, 0], [4, 2]]);
});

test("a corner is an edge without length, and what crosses has no clearance", () => {
  assert.equal(long(shortest([[0, 0], [0, 0]], [[3, 4], [3, 4]])), 5);
  assert.equal(long(shortest([[0, 0], [0, 0]], [[-5, 2], [5, 2]])), 2);
  assert.equal(long(shortest([[0, 0], [10, 10]], [[0, 10], [10, 0]])), 0);
});
