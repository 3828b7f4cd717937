/** Where the eye stands so that it sees points: as near as it can, in a direction that is given. */

import { Box3, type PerspectiveCamera, Quaternion, Vector3 } from "three";

/** Share of the picture that is filled. */
const FILLED = 0.9;

/** Corners of a box that has been turned and moved. */
export function boxCorners({ min, max }: Box3, turn: Quaternion, shift: Vector3): Vector3[] {
  return [0, 1, 2, 3, 4, 5, 6, 7].map((k) => new Vector3(k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z).applyQuaternion(turn).add(shift));
}

/** Points at rest and moved, the latter no farther out than `most` times the longest side of the box at rest: what leaves is seen on its way. */
export function around(rest: readonly Vector3[], moved: readonly Vector3[], most = 2): Vector3[] {
  const box = new Box3().setFromPoints([...rest]);
  const { x, y, z } = box.getSize(new Vector3());
  box.expandByScalar(most * Math.max(x, y, z));
  return [...rest, ...moved.map((point) => point.clone().clamp(box.min, box.max))];
}

/** Eye and target from which a camera, turned as it is, has all points in the middle of its picture, and how far they reach from the target. */
export function framed(points: readonly Vector3[], { quaternion, fov, aspect }: PerspectiveCamera): { eye: Vector3; target: Vector3; reach: number } {
  const back = new Quaternion().copy(quaternion).invert();
  const seen = points.map((point) => point.clone().applyQuaternion(back)); // x to the right, y upwards, z towards the eye
  const slope = FILLED * Math.tan((fov * Math.PI) / 360);
  // a point is in sight where |x - eye x| <= slope (eye z - z)
  const [x, far] = between(seen.map((one) => [one.x, one.z]), slope * aspect);
  const [y, high] = between(seen.map((one) => [one.y, one.z]), slope);
  const depths = seen.map((one) => one.z);
  const [nearest, farthest] = depths.reduce(([low, top], z) => [Math.min(low, z), Math.max(top, z)], [Infinity, -Infinity]);
  const middle = new Vector3(x, y, (nearest + farthest) / 2);
  const reach = seen.reduce((most, one) => Math.max(most, one.distanceTo(middle)), 0) || 1;
  const eye = new Vector3(x, y, Math.max(far, high, farthest + 0.05 * reach));
  return { eye: eye.applyQuaternion(quaternion), target: middle.applyQuaternion(quaternion), reach };
}

/** Place of the eye in one direction of the picture, and its least depth, for points (place, depth). */
function between(points: readonly (readonly [number, number])[], slope: number): [number, number] {
  let [low, top] = [Infinity, -Infinity];
  for (const [at, z] of points) {
    low = Math.min(low, at - slope * z);
    top = Math.max(top, at + slope * z);
  }
  return [(low + top) / 2, (top - low) / (2 * slope)];
}
