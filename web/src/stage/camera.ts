/** The view as a signal, with what buttons and keys do to it. */

import { signal } from "@preact/signals";
import { goals } from "../design.ts";
import { isPull } from "../protocol.ts";
import { drawing } from "../state.ts";
import type { Eye, SolidView } from "../stage3d.ts";
import { type Box, fit, type Inset, panned, type Size, toScreen, type View, zoomed } from "./view.ts";

export const view = signal<View>({ x: 0, y: 0, scale: 1 });
export const size = signal<Size>({ width: 0, height: 0 });
/** Box around what is drawn, at rest and moved [mm]; what is fitted. */
export const content = signal<Box>([0, 0, 1, 1]);
/** The view of parts in space, where such are open. */
export const solidView = signal<SolidView | null>(null);
/** From where they are seen. */
export const solidEye = signal<Eye | null>(null);
/** True until the user pans or zooms: then the drawing stays fitted when the canvas changes size. */
export const fitted = signal(true);

/** Room round the drawing: for the shortest arrow where something is pulled that way. */
function inset(): Inset {
  if (size.value.width >= 560) return { top: 22, right: ARROW_ROOM, bottom: 24, left: ARROW_ROOM };
  const towards = (axis: 0 | 1, sign: number): boolean => goals.value.some((goal) => isPull(goal) && goal.direction[axis] * sign > 0.3);
  const room = (least: number, pulled: boolean): number => (pulled ? ARROW_ROOM : least);
  return { top: room(14, towards(1, 1)), right: room(16, towards(0, 1)), bottom: room(14, towards(1, -1)), left: room(16, towards(0, -1)) };
}
/** Of the shortest arrow and its distance from the edge [px]. */
const ARROW_ROOM = 40;

export function fitAll(): void {
  if (solidView.peek()) return solidView.peek()!.fit();
  fitted.value = true;
  if (drawing.value && size.value.width) view.value = fit(content.value, size.value, inset());
}

/** Fits again where something of the box has left the canvas, or has become small in it. */
export function keepFitted(): void {
  if (!fitted.peek() || !drawing.peek() || !size.peek().width) return;
  const wanted = fit(content.peek(), size.peek(), inset());
  const [x0, y0, x1, y1] = content.peek();
  const corners = [toScreen(view.peek(), size.peek(), [x0, y0]), toScreen(view.peek(), size.peek(), [x1, y1])];
  const { width, height } = size.peek();
  const out = corners.some(([x, y]) => x < 4 || y < 4 || x > width - 4 || y > height - 4);
  if (out || wanted.scale > 1.4 * view.peek().scale) view.value = wanted;
}

export function zoomBy(factor: number, at?: [number, number]): void {
  if (solidView.peek()) return solidView.peek()!.zoom(factor);
  const { width, height } = size.value;
  const next = zoomed(view.value, size.value, at ?? [width / 2, height / 2], factor);
  const [x0, y0, x1, y1] = drawing.value?.size ?? [0, 0, 1, 1];
  const whole = Math.max(x1 - x0, y1 - y0, 1e-9) * next.scale;
  if (whole < 30 || whole > 4e6) return;
  fitted.value = false;
  view.value = kept(next);
}

/** Place of a pointer in a canvas [px]. */
export function pointIn(canvas: HTMLCanvasElement, { clientX, clientY }: MouseEvent): [number, number] {
  const box = canvas.getBoundingClientRect();
  return [clientX - box.left, clientY - box.top];
}

/** By how much a turn of the wheel zooms. */
export function wheelFactor(event: WheelEvent): number {
  const lines = event.deltaMode === 1 ? 16 : 1;
  return Math.exp(-event.deltaY * lines * (event.ctrlKey ? 0.01 : 0.0016));
}

export function panBy(dx: number, dy: number): void {
  fitted.value = false;
  view.value = kept(panned(view.value, dx, dy));
}

/** The view moved back so far that some of the drawing stays in it. */
function kept(next: View): View {
  const [x0, y0, x1, y1] = content.value;
  const [wide, high] = [(0.4 * size.value.width) / next.scale, (0.4 * size.value.height) / next.scale];
  return { ...next, x: Math.min(Math.max(next.x, x0 - wide), x1 + wide), y: Math.min(Math.max(next.y, y0 - high), y1 + high) };
}

/** Moves the view where a place is not in it. */
export function bringIntoView(at: [number, number]): void {
  const [x, y] = toScreen(view.value, size.value, at);
  const { width, height } = size.value;
  if (x < 20 || y < 20 || x > width - 20 || y > height - 20) {
    fitted.value = false;
    view.value = { ...view.value, x: at[0], y: at[1] };
  }
}
