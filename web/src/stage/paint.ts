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
  factor: number;
  chosen: ReadonlySet<number>;
  hovered: number;
  colours: Colours;
}

const SMALLEST = 3;
const NAMED = 70;
const MOST_NAMES = 140;
/** A ghost nearer than this [px] to its part is left out. */
const GHOST = 2;

/** The empty ground. */
export function clear(g: CanvasRenderingContext2D, size: Size, ratio: number, colours: Colours): void {
  g.setTransform(1, 0, 0, 1, 0, 0);
  g.fillStyle = colours.paper;
  g.fillRect(0, 0, size.width * ratio, size.height * ratio);
}

/**
 * Draws the parts; `rough` leaves out thin lines, for frames that come too slowly.
 * With a `group` only those of it, or all `besides` them.
 */
export function paint(
  g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, rough: boolean, group?: ReadonlySet<number>, besides = false,
): void {
  const { colours } = scene;
  const scale = view.scale * ratio;
  g.lineJoin = "round";
  const seen = visible(size, view, scene).filter(({ i }) => !group || group.has(i) !== besides);
  if (!rough && (!group || besides)) restOutlines(g, size, ratio, view, scene, group);
  let last = "";
  for (const { i, place } of seen) {
    const one = scene.shapes[i]!;
    const role = scene.roles[i] ?? "neutral";
    const [fill, edge] = colours[role];
    const tint = scene.blame ? blameColour(colours.blame, scene.blame[i]!) : fill;
    stand(g, size, ratio, view, place);
    if (last !== tint) g.fillStyle = last = tint;
    g.fill(one.path, "evenodd");
    if (role === "fixed" && one.radius * view.scale > 2 * SMALLEST) {
      g.fillStyle = last = "";
      g.fillStyle = hatch(g, scale, place, edge, ratio);
      g.fill(one.path, "evenodd");
    }
    if (rough || one.radius * view.scale < SMALLEST) continue;
    g.strokeStyle = edge;
    g.lineWidth = (role === "neutral" ? 1 : 1.4) / view.scale;
    g.stroke(one.path);
  }
  for (const found of seen) {
    if (scene.chosen.has(found.i)) ring(g, size, ratio, view, scene, found, true);
    else if (found.i === scene.hovered) ring(g, size, ratio, view, scene, found, false);
  }
  if (!rough) names(g, size, ratio, view, scene, seen);
}

/** Where the hand wants parts that may not get there: not known yet, so it does not look like parts. */
export function paintGhost(
  g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, group: readonly number[], [dx, dy]: readonly [number, number],
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

const onScreen = (size: Size, view: View, x: number, y: number, radius: number): boolean =>
  Math.abs(x - view.x) <= size.width / 2 / view.scale + radius && Math.abs(y - view.y) <= size.height / 2 / view.scale + radius;

/** Parts on the screen; fixed ones first, pulled ones last, so that what matters is not covered. */
function visible(size: Size, view: View, scene: Scene): Seen[] {
  const layers: Seen[][] = [[], [], []];
  scene.shapes.forEach((one, i) => {
    const place = placed(one, scene.motion, i, scene.factor);
    if (!onScreen(size, view, place.x, place.y, one.radius)) return;
    const role = scene.roles[i];
    layers[role === "fixed" ? 0 : role === "neutral" ? 1 : 2]!.push({ i, place });
  });
  return layers.flat();
}

/** Canvas transform under which a part's path is drawn in place. */
function stand(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, p: Placed): void {
  const [x, y] = toScreen(view, size, [p.x, p.y]);
  const [c, s] = [p.cos * view.scale * ratio, p.sin * view.scale * ratio];
  g.setTransform(c, -s, -s, -c, x * ratio, y * ratio);
}

function restOutlines(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, underHand?: ReadonlySet<number>): void {
  g.strokeStyle = scene.colours.rest;
  g.lineWidth = 1 / view.scale;
  for (let i = 0; i < scene.shapes.length; i++) {
    const one = scene.shapes[i]!;
    if (one.radius * view.scale < SMALLEST || !onScreen(size, view, one.at[0], one.at[1], one.radius)) continue;
    const place = placed(one, scene.motion, i, scene.factor);
    const away = Math.hypot(place.x - one.at[0], place.y - one.at[1]) + one.radius * Math.hypot(place.cos - 1, place.sin);
    if (away * view.scale < 0.6 && !underHand?.has(i)) continue;
    stand(g, size, ratio, view, { x: one.at[0], y: one.at[1], cos: 1, sin: 0 });
    g.stroke(one.path);
  }
}

function ring(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, { i, place }: Seen, chosen: boolean): void {
  stand(g, size, ratio, view, place);
  g.strokeStyle = chosen ? scene.colours.ink : scene.colours.quiet;
  g.lineWidth = (chosen ? 2.6 : 1.8) / view.scale;
  g.stroke(scene.shapes[i]!.path);
}

function names(g: CanvasRenderingContext2D, size: Size, ratio: number, view: View, scene: Scene, seen: Seen[]): void {
  if (seen.length > MOST_NAMES) return;
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.font = "500 12px system-ui, sans-serif";
  g.textAlign = "center";
  g.textBaseline = "middle";
  for (const { i, place } of seen) {
    const one = scene.shapes[i]!;
    if (one.width * view.scale < NAMED) continue;
    const name = scene.names[i]!;
    const [mx, my] = namePlace(one);
    const [x, y] = toScreen(view, size, [place.x + place.cos * mx - place.sin * my, place.y + place.sin * mx + place.cos * my]);
    const below = scene.roles[i] === "pulled" ? 20 : 0; // beside the foot of the arrow
    g.globalAlpha = 0.78;
    g.fillStyle = scene.blame ? inkOn(blameColour(scene.colours.blame, scene.blame[i]!)) : scene.colours.ink;
    g.fillText(name.length > 14 ? `${name.slice(0, 12)}…` : name, x, y + below, one.width * view.scale - 12);
  }
  g.globalAlpha = 1;
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
