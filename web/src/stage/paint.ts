/** Paints the parts on a Canvas 2D. Each part's path is kept; a frame only places it. */

import { blameColour, type Colours } from "./colours.ts";
import type { Role } from "./roles.ts";
import { namePlace, type Placed, placed, type Shape } from "./shapes.ts";
import { type Size, toScreen, type View } from "./view.ts";

export interface Scene {
  shapes: readonly Shape[];
  names: readonly string[];
  roles: readonly Role[];
  blame: Float32Array | null;
  motion: Float32Array;
  /** Whose motion it is: the number of a drag's request, or what is shown. */
  of: string;
  factor: number;
  chosen: ReadonlySet<number>;
  hovered: number;
  /** Parts under the hand: they are drawn over the others, and their outlines at rest always. */
  held: ReadonlySet<number>;
  colours: Colours;
}

const SMALLEST = 3;
/** Width of most lines [px]: Chromium paints what is no wider than a pixel as a hairline, ten times as fast without a graphics processor; a turned line of 1 may be wider by rounding. */
const HAIRLINE = 0.99;
const NAMED = 70;
/** A ghost nearer than this [px] to its part is left out. */
const GHOST = 2;

/** The empty ground. */
export function clear(g: CanvasRenderingContext2D, colours: Colours): void {
  g.setTransform(1, 0, 0, 1, 0, 0);
  g.fillStyle = colours.paper;
  g.fillRect(0, 0, g.canvas.width, g.canvas.height);
}

/** Draws all parts but those under the hand; `rough` leaves out thin lines, for frames that come too slowly. */
export function paint(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, rough = false, within?: Region): void {
  for (const _ of painting(g, size, ratio, view, scene, rough, within)) void _;
}

/** Part of the canvas [px]: x0, y0, x1, y1. */
export type Region = readonly [number, number, number, number];

/** The same in steps, one a part and one an outline at rest, so that frames may come between; where a region is given, no more than what reaches into it. */
export function* painting(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, rough: boolean, within?: Region): Generator<void> {
  const seen = visible(size, view, scene, within).filter(({ i }) => !scene.held.has(i));
  if (!rough) yield* restOutlines(g, size, ratio, view, scene, within);
  for (const one of seen) {
    body(g, size, ratio, view, scene, one, rough);
    yield;
  }
  rings(g, size, ratio, view, scene, seen);
  if (!rough) names(g, size, ratio, view, scene, seen);
}

/** Draws some parts over all others. */
export function paintOver(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, some: ReadonlySet<number>): void {
  const seen = visible(size, view, scene, undefined, some);
  for (const one of seen) body(g, size, ratio, view, scene, one, false);
  rings(g, size, ratio, view, scene, seen);
  names(g, size, ratio, view, scene, seen);
}

function body(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, { i, place }: Seen, rough: boolean): void {
  const { colours } = scene;
  const one = scene.shapes[i]!;
  const role = scene.roles[i] ?? "neutral";
  const [fill, edge] = colours[role];
  stand(g, size, ratio, view, place);
  g.lineJoin = "round";
  g.fillStyle = scene.blame ? blameColour(colours.blame, scene.blame[i]!) : fill;
  g.fill(one.path, "evenodd");
  if (role === "fixed" && one.radius * view.scale > 2 * SMALLEST) {
    g.fillStyle = hatch(g, view.scale * ratio, place, edge, ratio);
    g.fill(one.path, "evenodd");
  }
  if (rough || one.radius * view.scale < SMALLEST) return;
  g.strokeStyle = edge;
  g.lineWidth = (role === "neutral" ? HAIRLINE : 1.4) / view.scale;
  g.stroke(one.path);
}

function rings(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, seen: readonly Seen[]): void {
  for (const found of seen) {
    if (scene.chosen.has(found.i)) ring(g, size, ratio, view, scene, found, true);
    else if (found.i === scene.hovered) ring(g, size, ratio, view, scene, found, false);
  }
}

/** Where the hand wants parts that may not get there: not known yet, so it does not look like parts. */
export function paintGhost(
  g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, group: Iterable<number>, [dx, dy]: readonly [number, number],
): void {
  if (Math.hypot(dx, dy) * scene.factor * view.scale < GHOST) return;
  for (const i of group) {
    const one = scene.shapes[i]!;
    const at = placed(one, scene.motion, i, scene.factor);
    stand(g, size, ratio, view, { ...at, x: at.x + dx * scene.factor, y: at.y + dy * scene.factor });
    g.fillStyle = scene.colours.motion;
    g.globalAlpha = 0.1;
    g.fill(one.path, "evenodd");
    g.globalAlpha = 0.8;
    g.strokeStyle = scene.colours.motion;
    g.lineWidth = 1.2 / view.scale;
    g.setLineDash([5 / view.scale, 4 / view.scale]);
    g.stroke(one.path);
    g.setLineDash([]);
    g.globalAlpha = 1;
  }
}

interface Seen { i: number; place: Placed }

/** How far lines reach beyond a part, and names under the arrow of a pull [px]. */
const LINE = 3;
const NAME = 26;
/** How far a part, its lines and its name reach from its place [px]. */
export const extentOf = (view: View, radius: number): number => radius * view.scale + (2 * radius * view.scale < NAMED ? LINE : NAME);

/** Whether a disc reaches into a region, or else onto the screen. */
function onScreen(size: Size, view: View, x: number, y: number, radius: number, [x0, y0, x1, y1]: Region = [0, 0, size.width, size.height]): boolean {
  const [px, py] = toScreen(view, size, [x, y]);
  const far = extentOf(view, radius);
  return px >= x0 - far && px <= x1 + far && py >= y0 - far && py <= y1 + far;
}

/** Parts on the screen, all or some; fixed ones first, pulled ones last, so that what matters is not covered. */
function visible(size: Size, view: View, scene: Scene, within?: Region, some: Iterable<number> = scene.shapes.keys()): Seen[] {
  const layers: Seen[][] = [[], [], []];
  for (const i of some) {
    if (!reaches(size, view, scene, i, within)) continue;
    const role = scene.roles[i];
    layers[role === "fixed" ? 0 : role === "neutral" ? 1 : 2]!.push({ i, place: placed(scene.shapes[i]!, scene.motion, i, scene.factor) });
  }
  return layers.flat();
}

/** Whether a part, where it has moved to, reaches into a region or onto the screen. */
function reaches(size: Size, view: View, { shapes, motion, factor }: Scene, i: number, within?: Region): boolean {
  const { at, radius } = shapes[i]!;
  return onScreen(size, view, at[0] + motion[3 * i]! * factor, at[1] + motion[3 * i + 1]! * factor, radius, within);
}

/** How many steps it takes to paint a region: parts that reach into it, and outlines at rest. */
export function stepsIn(size: Size, view: View, scene: Scene, region: Region): number {
  let count = 0;
  for (let i = 0; i < scene.shapes.length; i++) {
    if (!scene.held.has(i) && reaches(size, view, scene, i, region)) count++;
    if (outlinedAtRest(size, view, scene, i, region)) count++;
  }
  return count;
}

/** Canvas transform under which a part's path is drawn in place. */
function stand(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, p: Placed): void {
  const [x, y] = toScreen(view, size, [p.x, p.y]);
  const [c, s] = [p.cos * view.scale * ratio, p.sin * view.scale * ratio];
  g.setTransform(c, -s, -s, -c, x * ratio, y * ratio);
}

/** How far from rest [px] a part must be for its outline there to be drawn. */
const AWAY = 0.6;

/** Whether the outline of a part at rest is drawn. */
const leftRest = (view: View, { shapes, motion, factor, held }: Scene, i: number): boolean =>
  held.has(i) || changed(shapes[i]!, motion, null, i) * factor * view.scale >= AWAY;

/** How far a part lies in one motion from where it is in another, or at rest [mm]: no corner lies farther. */
export const changed = ({ radius }: Shape, a: Float32Array, b: Float32Array | null, i: number): number =>
  Math.hypot(a[3 * i]! - (b?.[3 * i] ?? 0), a[3 * i + 1]! - (b?.[3 * i + 1] ?? 0)) + radius * Math.abs(a[3 * i + 2]! - (b?.[3 * i + 2] ?? 0));

function outlinedAtRest(size: Size, view: View, scene: Scene, i: number, within?: Region): boolean {
  const { at, radius } = scene.shapes[i]!;
  return radius * view.scale >= SMALLEST && leftRest(view, scene, i) && onScreen(size, view, at[0], at[1], radius, within);
}

function* restOutlines(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, within?: Region): Generator<void> {
  for (let i = 0; i < scene.shapes.length; i++) {
    const one = scene.shapes[i]!;
    if (!outlinedAtRest(size, view, scene, i, within)) continue;
    g.strokeStyle = scene.colours.rest;
    g.lineWidth = HAIRLINE / view.scale;
    stand(g, size, ratio, view, { x: one.at[0], y: one.at[1], cos: 1, sin: 0 });
    g.stroke(one.path);
    yield;
  }
}

function ring(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, { i, place }: Seen, chosen: boolean): void {
  stand(g, size, ratio, view, place);
  g.strokeStyle = chosen ? scene.colours.ink : scene.colours.quiet;
  g.lineWidth = (chosen ? 2.6 : 1.8) / view.scale;
  g.stroke(scene.shapes[i]!.path);
}

function names(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, seen: Seen[]): void {
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.font = "500 12px system-ui, sans-serif";
  g.textAlign = "center";
  g.textBaseline = "middle";
  for (const { i, place } of seen) {
    const one = scene.shapes[i]!;
    if (one.width * view.scale < NAMED) continue;
    const name = scene.names[i]!;
    const { at: [mx, my], room: wide } = namePlace(one);
    const room = NAME_SHARE * wide * view.scale;
    if (room < LEAST_NAME) continue;
    const [x, y] = toScreen(view, size, [place.x + place.cos * mx - place.sin * my, place.y + place.sin * mx + place.cos * my]);
    const below = scene.roles[i] === "pulled" ? 20 : 0; // beside the foot of the arrow
    g.globalAlpha = 0.78;
    g.fillStyle = scene.blame ? inkOn(blameColour(scene.colours.blame, scene.blame[i]!)) : scene.colours.ink;
    g.fillText(cut(g, name, room), x, y + below);
  }
  g.globalAlpha = 1;
}

/** Names take this share of the width of a part where they stand, and are left out where that is less than a letter or two [px]. */
const NAME_SHARE = 0.9;
const LEAST_NAME = 18;
const cuts = new Map<string, string>();

/** A name, or as much of its beginning as is no wider than `room` [px]. */
function cut(g: CanvasRenderingContext2D, name: string, room: number): string {
  const key = `${Math.floor(room / 8)} ${name}`;
  let found = cuts.get(key);
  if (found === undefined) {
    const letters = [...name];
    found = name;
    while (letters.length > 1 && g.measureText(found).width > room) found = `${(letters.pop(), letters.join(""))}…`;
    if (cuts.size > 4000) cuts.clear();
    cuts.set(key, found);
  }
  return found;
}

/** Dark or light ink, whichever is read better on a colour given as rgb(r,g,b). */
function inkOn(rgb: string): string {
  const [r, g, b] = rgb.match(/\d+/g)!.map(Number);
  return 0.299 * r! + 0.587 * g! + 0.114 * b! > 140 ? "#1f2933" : "#ffffff";
}

const tiles = new Map<string, CanvasPattern>();

/** Diagonal lines in the colour of the edge, of the same width on the screen at every zoom: fixed is not a colour alone. */
function hatch(g: CanvasRenderingContext2D, scale: number, p: Placed, colour: string, ratio: number): CanvasPattern {
  const key = `${colour} ${ratio}`;
  let pattern = tiles.get(key);
  if (!pattern) {
    const side = Math.round(8 * ratio);
    const tile = document.createElement("canvas");
    tile.width = tile.height = side;
    const t = tile.getContext("2d")!;
    t.strokeStyle = colour;
    t.globalAlpha = 0.55;
    t.lineWidth = 1.1 * ratio;
    t.beginPath();
    for (const shift of [-side, 0, side]) {
      t.moveTo(shift - 1, side + 1);
      t.lineTo(shift + side + 1, -1);
    }
    t.stroke();
    pattern = g.createPattern(tile, "repeat")!;
    tiles.set(key, pattern);
  }
  pattern.setTransform(new DOMMatrix([p.cos / scale, -p.sin / scale, -p.sin / scale, -p.cos / scale, 0, 0]));
  return pattern;
}
