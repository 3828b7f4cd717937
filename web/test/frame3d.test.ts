import assert from "node:assert/strict";
import { test } from "node:test";
import { PerspectiveCamera, Vector3 } from "three";
import { around, framed } from "../src/frame3d.ts";

/** Where points are in the picture, from -1 to 1, seen from where a camera is put. */
function pictured(points: readonly Vector3[], from: Vector3, aspect: number): Vector3[] {
  const camera = new PerspectiveCamera(30, aspect, 0.001, 1e6);
  camera.up.set(0, 0, 1);
  camera.position.copy(from);
  camera.lookAt(0, 0, 0);
  const { eye, target, reach } = framed(points, camera);
  camera.position.copy(eye);
  const before = camera.quaternion.clone();
  camera.lookAt(target);
  assert.ok(before.angleTo(camera.quaternion) < 1e-6, "it is seen from another side");
  assert.ok(points.every((point) => point.distanceTo(target) <= reach * (1 + 1e-9)));
  camera.updateMatrixWorld();
  return points.map((point) => point.clone().project(camera));
}

const corners = (x: number, y: number, z: number, at: Vector3): Vector3[] =>
  [0, 1, 2, 3, 4, 5, 6, 7].map((k) => new Vector3(k & 1 ? x : 0, k & 2 ? y : 0, k & 4 ? z : 0).add(at));

test("long, tall and far boxes fill the picture from every side, and nothing is cut off", () => {
  for (const [x, y, z] of [[1, 1, 1], [400, 5, 5], [5, 400, 5], [3, 3, 300], [200, 300, 0], [1e-3, 1e-3, 2e-3]] as const) {
    for (const from of [new Vector3(1.25, -1.35, 0.98), new Vector3(1, 0.01, 0.02), new Vector3(0.1, 0.2, 5), new Vector3(-1, -1, -2)]) {
      for (const aspect of [0.5, 1, 2.2]) {
        const seen = pictured(corners(x, y, z, new Vector3(500, -20, 7)), from, aspect);
        const [wide, high] = (["x", "y"] as const).map((k) => [Math.min(...seen.map((p) => p[k])), Math.max(...seen.map((p) => p[k]))] as const) as [readonly [number, number], readonly [number, number]];
        assert.ok([...wide, ...high].every((v) => Math.abs(v) < 0.91), `${x} ${y} ${z}: ${wide} ${high}`);
        const filled = [wide, high].some(([low, top]) => Math.abs(low + 0.9) < 1e-3 && Math.abs(top - 0.9) < 1e-3);
        const near = seen.some((p) => p.z < -0.99); // or the eye is as near as it may come
        assert.ok(filled || near, `${x} ${y} ${z}, ${aspect}: ${wide} ${high}`);
      }
    }
  }
});

test("what goes far is followed as far as it stays near", () => {
  const rest = corners(10, 2, 2, new Vector3());
  const [there] = around(rest, [new Vector3(1662, 1, 1)]).slice(8);
  assert.deepEqual(there!.toArray(), [30, 1, 1]);
  const [near] = around(rest, [new Vector3(12, 1, 1)]).slice(8);
  assert.deepEqual(near!.toArray(), [12, 1, 1]);
});
