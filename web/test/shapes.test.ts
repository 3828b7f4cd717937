/** How long a name may be where it stands. */

import assert from "node:assert/strict";
import { test } from "node:test";
import type { Ring } from "../src/protocol.ts";
import { widthAt } from "../src/stage/shapes.ts";

const square = (low: number, high: number): Ring => [[low, low], [high, low], [high, high], [low, high]];

test("in the arm of a frame a name is as long as the arm is wide", () => {
  const frame = [square(0, 100), square(20, 80)];
  assert.equal(widthAt(frame, [10, 50]), 20);
  assert.equal(widthAt(frame, [95, 50]), 10, "both halves of a name are as long");
  assert.equal(widthAt(frame, [50, 10]), 100, "below the hole");
});

test("outside there is no room", () => assert.equal(widthAt([square(0, 10)], [20, 5]), 0));
