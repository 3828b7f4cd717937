/** What lies over the canvas as SVG: the arrow of a pull or a turn, with handles to take it elsewhere. */

import { useRef } from "preact/hooks";
import { design, goals, setGoal, settle } from "../design.ts";
import { factor, shown } from "../motion.ts";
import { type Goal, isPull, isTurn, type Point, type Pull } from "../protocol.ts";
import { standalone, drawing, extent, indexOf, pointed, reach, selected, shaped, shapedNow, unsure } from "../state.ts";
import { lassoed } from "./lasso.ts";
import { size, view } from "./camera.ts";
import { ends, long, picked, shortest } from "./measure.ts";
import { current, frame, gripAt, partAt } from "./now.ts";
import { outOf, placed } from "./shapes.ts";
import { number } from "../words.ts";
import { toScreen } from "./view.ts";

/** What is nearer than this share of the drawing touches: outlines are told no finer. */
const TOUCHING = 1e-6;
const LONG = 74;
const SHORT = 34;
const EDGE = 6;
/** Arrows of more goals than these would cover the drawing. */
const MAX_ARROWS = 60;

export function Overlay() {
  void frame.value;
  const { width, height } = size.value;
  if (!drawing.value || !width || shown.value.what === "escape") return null;
  const spot = pointed.value?.point && toScreen(view.value, size.value, pointed.value.point);
  return (
    <svg class="overlay" width={width} height={height} aria-hidden="true">
      {spot && <circle class="spot" cx={spot[0]} cy={spot[1]} r={16} />}
      <Reach />
      <Measure />
      {lassoed.value.length > 2 && <polygon class="lasso" points={lassoed.value.map((p) => p.join()).join(" ")} />}
      {goals.value.slice(0, MAX_ARROWS).map((goal, i) => {
        const at = anchor(goal);
        if (!at) return null;
        if (isPull(goal)) return <PullArrow key={i} goal={goal} index={i} at={at} />;
        return isTurn(goal) ? <TurnArrow key={i} at={at} ccw={goal.turn === "ccw"} /> : null;
      })}
    </svg>
  );
}

/** Where the chosen part can be brought by its grip. */
function Reach() {
  const about = reach.value;
  if (!about || about.design !== design.value || about.reply.part !== selected.value) return null;
  const { rings, grip, exact } = about.reply;
  const f = factor();
  const screen = ([x, y]: Point): Point => toScreen(view.value, size.value, [grip[0] + (x - grip[0]) * f, grip[1] + (y - grip[1]) * f]);
  const path = rings.map((ring) => `M${ring.map((p) => screen(p).map((v) => v.toFixed(1)).join(" ")).join("L")}Z`).join("");
  const [x, y] = screen(grip);
  return <g class={exact ? "reach" : "reach sampled"}><path d={path} fill-rule="evenodd" /><circle cx={x} cy={y} r={3} /></g>;
}

/** What was picked to measure, and how far it is apart: true lengths, whatever the motion is enlarged by. */
function Measure() {
  void frame.value; // parts move
  const some = picked.value;
  if (some.length === 0 || some.some(({ part }) => !current.shapes[part])) return null;
  const screen = (p: Point): Point => toScreen(view.value, size.value, p);
  const drawn = some.map((one) => ends(one, factor()));
  const lines = drawn.map((pair) => pair.map(screen) as [Point, Point]);
  const [one, other] = drawn;
  const segment = other ? (shortest(one!, other).map(screen) as [Point, Point]) : null;
  const [a, b] = some.map((feature) => ends(feature, 1));
  const far = b ? long(shortest(a!, b)) : 0;
  const guess = unsure.value || shown.value.what === "between" || (shaped.value !== null && !shapedNow.value); // parts are not as they are drawn
  const unmade = shaped.value ? "" : " as drawn"; // no gap is taken off
  const words = !b || guess ? "" : (far < TOUCHING * extent.value.radius ? "they touch" : `${number(far, 4)} mm`) + unmade;
  const middle: Point | null = segment && [(segment[0][0] + segment[1][0]) / 2, (segment[0][1] + segment[1][1]) / 2];
  return (
    <g class="measure">
      {lines.map(([[x1, y1], [x2, y2]], i) => (x1 === x2 && y1 === y2 ? <circle key={i} cx={x1} cy={y1} r={5} /> : <line key={i} class="edge" x1={x1} y1={y1} x2={x2} y2={y2} />))}
      {segment && <line class="segment" x1={segment[0][0]} y1={segment[0][1]} x2={segment[1][0]} y2={segment[1][1]} />}
      {middle && <text x={Math.min(Math.max(middle[0], 60), size.value.width - 60)} y={Math.max(middle[1] - 14, 16)}>{words}</text>}
    </g>
  );
}

/** Where a goal takes hold, on the screen. */
function anchor(goal: Goal): Point | null {
  const i = indexOf.value.get(goal.part);
  const shape = i === undefined ? undefined : current.shapes[i];
  if (!shape || current.motion.length < 3 * i! + 3) return null;
  const grip = isPull(goal) && goal.point ? goal.point : shape.at;
  const local: Point = [grip[0] - shape.at[0], grip[1] - shape.at[1]];
  return toScreen(view.value, size.value, outOf(placed(shape, current.motion, i!, factor()), local));
}

/** How far an arrow can go along one axis before it leaves the canvas. */
const room = (from: number, step: number, width: number): number => (step === 0 ? LONG : ((step > 0 ? width : 0) - from) / step - EDGE);

const SNAP = (4 * Math.PI) / 180;

/** Direction on the plane from a vector on the screen, drawn to the eighths of a turn when it is near one. */
export function aim(dx: number, dy: number): Point {
  const angle = Math.atan2(-dy, dx);
  const eighth = Math.round(angle / (Math.PI / 4)) * (Math.PI / 4);
  const used = Math.abs(angle - eighth) < SNAP ? eighth : angle;
  return [Math.cos(used), Math.sin(used)].map((v) => Number(v.toFixed(4)) + 0) as Point;
}

function PullArrow({ goal, index, at }: { goal: Pull; index: number; at: Point }) {
  const held = useRef<"base" | "head" | null>(null);
  const place = useRef<Point | null>(null);
  const long = Math.hypot(...goal.direction) || 1;
  const [ux, uy] = [goal.direction[0] / long, -goal.direction[1] / long];
  const [x, y] = held.current === "base" && place.current ? place.current : at;
  const far = Math.max(SHORT, Math.min(LONG, room(x, ux, size.value.width), room(y, uy, size.value.height)));
  const [hx, hy] = [x + ux * far, y + uy * far];
  const here = (event: PointerEvent): Point => {
    const box = (event.currentTarget as Element).closest("svg")!.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const press = (what: "base" | "head") => (event: PointerEvent) => {
    if (standalone.value) return;
    (event.currentTarget as Element).setPointerCapture(event.pointerId);
    held.current = what;
    event.stopPropagation();
  };
  const move = (event: PointerEvent): void => {
    if (!held.current) return;
    const to = here(event);
    if (held.current === "head") setGoal(index, { ...goal, direction: aim(to[0] - at[0], to[1] - at[1]) }, "aim");
    else {
      place.current = to;
      frame.value++;
    }
  };
  const lift = (): void => {
    const to = place.current;
    if (held.current === "base" && to) {
      const name = partAt(to);
      if (name) setGoal(index, { ...goal, part: name, point: gripAt(name, to).map((v) => Number(v.toPrecision(6))) as Point });
    }
    held.current = place.current = null;
    settle();
  };
  const handlers = { onPointerMove: move, onPointerUp: lift, onPointerCancel: lift };
  const [px, py] = [-uy, ux];
  const back = 15;
  const head = `${hx},${hy} ${hx - ux * back + px * 7},${hy - uy * back + py * 7} ${hx - ux * back - px * 7},${hy - uy * back - py * 7}`;
  return (
    <g class="pull">
      <line class="casing" x1={x} y1={y} x2={hx - ux * 6} y2={hy - uy * 6} />
      <polygon class="casing" points={head} />
      <line class="shaft" x1={x} y1={y} x2={hx - ux * 12} y2={hy - uy * 12} />
      <polygon class="head" points={head} />
      <circle class="base" cx={x} cy={y} r={5.5} />
      <circle class="grab" cx={x} cy={y} r={13} onPointerDown={press("base")} {...handlers}>
        <title>pull: take it to another part</title>
      </circle>
      <circle class="grab" cx={hx - ux * 6} cy={hy - uy * 6} r={17} onPointerDown={press("head")} {...handlers}>
        <title>pull: turn it</title>
      </circle>
    </g>
  );
}

function TurnArrow({ at: [x, y], ccw }: { at: Point; ccw: boolean }) {
  const radius = 30;
  const flip = ccw ? 1 : -1;
  const point = (degrees: number): Point => {
    const a = (degrees * Math.PI) / 180;
    return [x + flip * radius * Math.cos(a), y - radius * Math.sin(a)];
  };
  const [a, b] = [point(-50), point(170)];
  const arc = `M${a} A${radius} ${radius} 0 1 ${ccw ? 0 : 1} ${b}`;
  const head = `${b[0]},${b[1] + 13} ${b[0] - 8},${b[1] - 2} ${b[0] + 8},${b[1] - 2}`;
  return (
    <g class="pull">
      <path class="casing" d={arc} />
      <path class="shaft" d={arc} />
      <polygon class="head" points={head} />
    </g>
  );
}
