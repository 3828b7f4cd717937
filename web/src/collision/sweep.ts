/**
 * How far a body goes straight among bodies that stand still: exact translational sweep of polygons, and sliding along what it meets.
 *
 * Of two polygons in translation the first contact is always a corner of one on an edge of the other, so it is enough to send every
 * corner of the moving one along the path, and every corner of the others back along it.
 */

import { type Outline, RUN } from "./outline.ts";

/** An outline at a place in the world. */
export interface Body { outline: Outline; x: number; y: number; cos: number; sin: number }

export interface Contact {
  /** Share 0..1 of the path that is free. */
  share: number;
  /** Unit normal of what was met, towards the moving body. */
  nx: number;
  ny: number;
}

const FREE: Contact = { share: 1, nx: 0, ny: 0 };
const PARALLEL = 1e-9;
const SLIDES = 5;

/** First contact of moving bodies, shifted by (ox, oy), on the path (dx, dy) among standing ones; `clearance` [mm] is kept between them. */
export function firstContact(moving: readonly Body[], standing: readonly Body[], ox: number, oy: number, dx: number, dy: number, clearance: number): Contact {
  let best = FREE;
  const far = Math.hypot(dx, dy);
  for (const a of moving) for (const b of standing) {
    const apart = Math.hypot(b.x - a.x - ox, b.y - a.y - oy);
    if (apart > a.outline.radius + b.outline.radius + far + clearance) continue;
    best = cornersOnEdges(a, b, ox, oy, dx, dy, clearance, 1, best);
    best = cornersOnEdges(b, a, -ox, -oy, -dx, -dy, clearance, -1, best);
  }
  return best;
}

/** Corners of `a`, shifted by (ox, oy), that go by (dx, dy) and meet edges of `b`; `side` is -1 where it is `b` that moves. */
function cornersOnEdges(a: Body, b: Body, ox: number, oy: number, dx: number, dy: number, clearance: number, side: number, best: Contact): Contact {
  const { outline: from } = a;
  const { x: bx, y: by, next, boxes } = b.outline;
  // all in the frame of b
  const [cos, sin] = [a.cos * b.cos + a.sin * b.sin, a.sin * b.cos - a.cos * b.sin];
  const turn = (vx: number, vy: number): [number, number] => [b.cos * vx + b.sin * vy, -b.sin * vx + b.cos * vy];
  const [sx, sy] = turn(a.x + ox - b.x, a.y + oy - b.y);
  const [vx, vy] = turn(dx, dy);
  const reach = b.outline.radius + clearance;
  const far = Math.hypot(vx, vy);
  for (let i = 0; i < from.x.length; i++) {
    const px = sx + cos * from.x[i]! - sin * from.y[i]!;
    const py = sy + sin * from.x[i]! + cos * from.y[i]!;
    const [left, right] = [Math.min(px, px + vx * best.share) - clearance, Math.max(px, px + vx * best.share) + clearance];
    const [low, high] = [Math.min(py, py + vy * best.share) - clearance, Math.max(py, py + vy * best.share) + clearance];
    if (left > reach || right < -reach || low > reach || high < -reach) continue;
    for (let r = 0; 4 * r < boxes.length; r++) {
      if (left > boxes[4 * r + 2]! || right < boxes[4 * r]! || low > boxes[4 * r + 3]! || high < boxes[4 * r + 1]!) continue;
      for (let k = r * RUN; k < Math.min((r + 1) * RUN, bx.length); k++) {
        const n = next[k]!;
        const [ex, ey] = [bx[n]! - bx[k]!, by[n]! - by[k]!];
        const long = Math.hypot(ex, ey);
        if (long === 0) continue;
        const [nx, ny] = [ey / long, -ex / long]; // outward: material lies left
        const speed = nx * vx + ny * vy;
        if (speed > -PARALLEL * far) continue;
        const above = nx * (px - bx[k]!) + ny * (py - by[k]!);
        if (above < -clearance) continue; // behind the line: comes from elsewhere
        const share = Math.max((above - clearance) / -speed, 0);
        if (share >= best.share) continue;
        const along = (ex * (px + share * vx - bx[k]!) + ey * (py + share * vy - by[k]!)) / long;
        if (along < -clearance || along > long + clearance) continue;
        best = { share, nx: side * (b.cos * nx - b.sin * ny), ny: side * (b.sin * nx + b.cos * ny) };
      }
    }
  }
  return best;
}

/** Shift (x, y) [mm] of moving bodies towards a desired place, straight and then along what they meet; nothing is ever passed through. */
export function slideTowards(moving: readonly Body[], standing: readonly Body[], desired: readonly [number, number], clearance: number): [number, number] {
  let [x, y] = [0, 0];
  let [dx, dy] = desired;
  const met: Contact[] = [];
  for (let k = 0; k < SLIDES && Math.hypot(dx, dy) > clearance; k++) {
    const contact = firstContact(moving, standing, x, y, dx, dy, clearance);
    [x, y] = [x + contact.share * dx, y + contact.share * dy];
    if (contact.share === 1) break;
    met.push(contact);
    [dx, dy] = allowed(desired[0] - x, desired[1] - y, met);
  }
  return [x, y];
}

/** What of a desired shift is left that leads into none of the contacts: the shift, or its part along one of them, or nothing. */
function allowed(wx: number, wy: number, met: readonly Contact[]): [number, number] {
  const into = (x: number, y: number): boolean => met.some(({ nx, ny }) => nx * x + ny * y < -1e-9 * Math.hypot(wx, wy));
  if (!into(wx, wy)) return [wx, wy];
  let best: [number, number] = [0, 0];
  for (const { nx, ny } of met) {
    const along = -ny * wx + nx * wy;
    const [x, y] = [-ny * along, nx * along];
    if (!into(x, y) && Math.hypot(x, y) > Math.hypot(...best)) best = [x, y];
  }
  return best;
}
