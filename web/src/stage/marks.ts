/** Marks over the parts: contacts with their forces, and the thread from a dragged point to the pointer. */

import type { ContactEntry, Point } from "../protocol.ts";
import type { Colours } from "./colours.ts";
import { into, outOf, placed, type Shape } from "./shapes.ts";
import { type Size, toScreen, type View } from "./view.ts";

export interface Marks {
  contacts: readonly ContactEntry[];
  /** True end of the motion that the contacts belong to. */
  at: Float32Array;
  thread: { from: Point; to: Point } | null;
  highlit: Point | null;
}

const MOST_MARKS = 120;
/** A mark has so much of the picture to itself [px2]. */
const MARK_AREA = 4000;

/** More marks would hide the parts. */
export const mostMarks = ({ width, height }: Size): number => Math.min(MOST_MARKS, Math.ceil((width * height) / MARK_AREA));

/** A contact and where it is on the screen [px]. */
export interface Spot { contact: ContactEntry; x: number; y: number }

/** Of the contacts that are in view the strongest: coming nearer shows others. */
export function strongest(spots: readonly Spot[], { width, height }: Size, most: number): Spot[] {
  const seen = spots.filter(({ x, y }) => x >= 0 && x <= width && y >= 0 && y <= height);
  return seen.length > most ? seen.sort((a, b) => b.contact.force - a.contact.force).slice(0, most) : seen;
}

/** Paints them; the contacts that are drawn, and where. */
export function paintMarks(
  g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, colours: Colours,
  shapes: readonly Shape[], indexOf: ReadonlyMap<string, number>, motion: Float32Array, factor: number, marks: Marks,
): Spot[] {
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  const longest = Math.min(32, Math.min(size.width, size.height) / 18);
  const most = marks.contacts.reduce((largest, { force }) => Math.max(largest, force), 1e-12);
  const spots = marks.contacts.flatMap((contact): Spot[] => {
    const i = indexOf.get(contact.parts[0]);
    if (i === undefined) return [];
    const carrier = shapes[i]!;
    const local = into(placed(carrier, marks.at, i, 1), contact.point as Point);
    const [x, y] = toScreen(view, size, outOf(placed(carrier, motion, i, factor), local));
    return [{ contact, x, y }];
  });
  const drawn = strongest(spots, size, mostMarks(size));
  for (const { contact, x, y } of drawn) {
    const share = contact.force / most;
    const picked = marks.highlit !== null && marks.highlit[0] === contact.point[0] && marks.highlit[1] === contact.point[1];
    if (share > 1e-3) force(g, [x, y], contact.normal as Point, 8 + longest * Math.sqrt(share), colours.force, colours.paper);
    dot(g, x, y, picked ? 6 : share > 1e-3 ? 3.2 : 2, colours.force, colours.paper);
  }
  if (marks.thread) {
    const [a, b] = [toScreen(view, size, marks.thread.from), toScreen(view, size, marks.thread.to)];
    g.strokeStyle = colours.motion;
    g.lineWidth = 1.4;
    g.setLineDash([4, 4]);
    g.beginPath();
    g.moveTo(...a);
    g.lineTo(...b);
    g.stroke();
    g.setLineDash([]);
    dot(g, a[0], a[1], 4.5, colours.motion, colours.paper);
    dot(g, b[0], b[1], 2.5, colours.motion, colours.paper);
  }
  return drawn;
}

function dot(g: CanvasRenderingContext2D, x: number, y: number, radius: number, fill: string, edge: string): void {
  g.beginPath();
  g.arc(x, y, radius, 0, 2 * Math.PI);
  g.fillStyle = fill;
  g.fill();
  g.strokeStyle = edge;
  g.lineWidth = 1.2;
  g.stroke();
}

/** Arrow that presses on the contact, as long as the force is large, with an edge that stays apart from any fill. */
function force(g: CanvasRenderingContext2D, [x, y]: Point, normal: Point, length: number, colour: string, edge: string): void {
  const long = Math.hypot(normal[0], normal[1]) || 1;
  const [ux, uy] = [normal[0] / long, -normal[1] / long];
  const [tx, ty] = [x + ux * length, y + uy * length];
  const head = Math.min(7, length * 0.5);
  for (const [style, width] of [[edge, 4.2], [colour, 2]] as const) {
    g.strokeStyle = style;
    g.lineWidth = width;
    g.lineCap = "round";
    g.beginPath();
    g.moveTo(x, y);
    g.lineTo(tx, ty);
    g.moveTo(tx - head * (ux * 0.86 - uy * 0.5), ty - head * (uy * 0.86 + ux * 0.5));
    g.lineTo(tx, ty);
    g.lineTo(tx - head * (ux * 0.86 + uy * 0.5), ty - head * (uy * 0.86 - ux * 0.5));
    g.stroke();
  }
  g.lineCap = "butt";
}
