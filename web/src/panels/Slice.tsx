/** One slice of a free space as a flat drawing, at the scale of all of them, with the present state. */

import type { SpaceReply } from "../protocol.ts";

const SIDE = 220;
const PAD = 12;

export function Slice({ slices, which, state, here }: { slices: SpaceReply["slices"]; which: number; state: [number, number, number] | null; here: boolean }) {
  const all = slices.flatMap((one) => one.rings.flat());
  if (all.length === 0) return null;
  const [xs, ys] = [0, 1].map((k) => [...all.map((p) => p[k]!), ...(state ? [state[k]!] : [])]) as [number[], number[]];
  const [x0, x1] = [Math.min(...xs), Math.max(...xs)];
  const [y0, y1] = [Math.min(...ys), Math.max(...ys)];
  const scale = (SIDE - 2 * PAD) / Math.max(x1 - x0, y1 - y0, 1e-12);
  const [left, top] = [(SIDE - (x1 - x0) * scale) / 2, (SIDE - (y1 - y0) * scale) / 2];
  const at = (x: number, y: number): string => `${(left + (x - x0) * scale).toFixed(2)} ${(top + (y1 - y) * scale).toFixed(2)}`;
  const path = slices[which]!.rings.map((ring) => `M${ring.map(([x, y]) => at(x, y)).join("L")}Z`).join("");
  const [sx, sy] = state ? at(state[0], state[1]).split(" ") : [];
  return (
    <svg class="slice" viewBox={`0 0 ${SIDE} ${SIDE}`} role="img" aria-label={`slice at ${slices[which]!.angle_deg.toFixed(2)} degrees`}>
      <path class="free" d={path} fill-rule="evenodd" />
      <path class="cross" d={`M${at(0, y0)}L${at(0, y1)}M${at(x0, 0)}L${at(x1, 0)}`} />
      {state && <circle class={here ? "state" : "state elsewhere"} cx={sx} cy={sy} r={4} />}
    </svg>
  );
}
