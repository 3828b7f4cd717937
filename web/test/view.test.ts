import assert from "node:assert/strict";
import { test } from "node:test";
import { fit, panned, toScreen, toWorld, zoomed } from "../src/stage/view.ts";

const size = { width: 800, height: 600 };
const near = (a: readonly number[], b: readonly number[]): void => a.forEach((v, i) => assert.ok(Math.abs(v - b[i]!) < 1e-9, `${a} is not ${b}`));

test("the middle of the view is the middle of the canvas, and y points up", () => {
  const view = { x: 10, y: 20, scale: 5 };
  near(toScreen(view, size, [10, 20]), [400, 300]);
  near(toScreen(view, size, [11, 21]), [405, 295]);
  near(toWorld(view, size, toScreen(view, size, [-3.25, 7.5])), [-3.25, 7.5]);
});

test("a drawing is fitted into what is not covered", () => {
  const inset = { top: 100, right: 50, bottom: 20, left: 10 };
  const view = fit([0, 0, 200, 10], size, inset);
  near(toScreen(view, size, [0, 5]), [10, 100 + (600 - 120) / 2]);
  near(toScreen(view, size, [200, 5]), [750, 100 + (600 - 120) / 2]);
});

test("zooming keeps the point under the pointer, panning moves by pixels", () => {
  const view = { x: 3, y: -2, scale: 7 };
  const before = toWorld(view, size, [123, 456]);
  near(toWorld(zoomed(view, size, [123, 456], 2.5), size, [123, 456]), before);
  near(toScreen(panned(view, 30, -12), size, [3, -2]), [430, 288]);
});
