/** The gap: a slider, a box, and above them the curve of the motion that grows with every gap that was solved. */

import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { asks, design, goals, settle } from "../design.ts";
import { valueBetween } from "../motion.ts";
import { isPull, isTurn } from "../protocol.ts";
import { ask, setGap } from "../session.ts";
import { answer, baked, drawing, lost, running, solved } from "../state.ts";
import { nearestBy, number } from "../words.ts";
import { Button } from "./Button.tsx";
import { NumberBox } from "./NumberBox.tsx";
import { stepOf } from "./Selection.tsx";

const HIGH = 74;
const PAD = 9; // half of the thumb: the curve stands exactly over the slider

export function GapStrip() {
  const top = useSignal(0);
  const width = useSignal(0);
  const box = useRef<HTMLDivElement>(null);
  const opened = drawing.value;
  const gap = design.value.gap;
  useEffect(() => {
    top.value = opened ? firstTop(opened) : 0;
  }, [opened]);
  useEffect(() => {
    if (!box.current) return;
    const watch = new ResizeObserver(([entry]) => (width.value = entry!.contentRect.width));
    watch.observe(box.current);
    return () => watch.disconnect();
  }, [opened === null]);
  if (!opened || (baked.value && solved.value.length < 2)) return null;
  const still = baked.value !== null;
  const gaps = solved.value.map((one) => one.gap);
  const most = still ? Math.max(...gaps, 1e-9) : niceTop(Math.max(top.value, gap, ...gaps));
  const low = still ? Math.min(...gaps) : 0;
  return (
    <section class="gapstrip" aria-label="gap">
      <div class="gapbox">
        <label for="gap">Gap</label>
        <NumberBox value={gap} min={0} step={stepOf(gap || most / 10)} unit="mm" label="gap" onChange={(value) => setGap(value, "")} disabled={still} />
        {!still && (
          <Button label="Solve a row of gaps" onClick={() => sweep(most)} disabled={!asks(design.value) || running.value.has("sweep")} class="small">
            {running.value.has("sweep") ? "Sweeping…" : "Sweep"}
          </Button>
        )}
      </div>
      <div class="gapcurve" ref={box}>
        <Curve width={width.value} low={low} most={most} gap={gap} />
        <input
          id="gap" type="range" min={low} max={most} step={still ? (most - low) / 400 || 1e-6 : stepOf(most / 30)} value={gap}
          aria-valuetext={`${number(gap)} mm`} onInput={(event) => setGap(slid(Number(event.currentTarget.value), most))} onPointerUp={settle} onBlur={settle}
        />
      </div>
    </section>
  );
}

/** The slider gives round numbers, except on a baked page, where only stored gaps have answers. */
function slid(value: number, most: number): number {
  const step = stepOf(most / 30);
  if (!baked.value) return Number((Math.round(value / step) * step).toPrecision(6));
  return nearestBy(solved.value, (one) => one.gap, value)!.gap;
}

function sweep(most: number): void {
  const gaps = Array.from({ length: 10 }, (_, i) => Number(((most * (i + 1)) / 10).toPrecision(6)));
  ask("sweep", { design: design.peek(), gaps });
}

function firstTop(opened: { gap: number; size: readonly [number, number, number, number]; parts: readonly unknown[] }): number {
  const [x0, y0, x1, y1] = opened.size;
  const usual = Math.sqrt(((x1 - x0) * (y1 - y0)) / Math.max(opened.parts.length, 1));
  return opened.gap > 0 ? opened.gap * 2.5 : usual / 20;
}

function niceTop(value: number): number {
  const power = 10 ** Math.floor(Math.log10(Math.max(value, 1e-9)));
  for (const lead of [1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10]) if (lead * power >= value * (1 - 1e-9)) return Number((lead * power).toPrecision(6));
  return value;
}

function Curve({ width, low, most, gap }: { width: number; low: number; most: number; gap: number }) {
  if (width < 40) return <svg class="curve" height={HIGH} aria-hidden="true" />;
  const x = (g: number): number => PAD + ((g - low) / Math.max(most - low, 1e-12)) * (width - 2 * PAD);
  const known = solved.value.filter((one) => one.objective !== null && one.gap <= most);
  const high = Math.max(...known.map((one) => one.objective!), 1e-9);
  const y = (v: number): number => HIGH - 4 - (v / high) * (HIGH - 20);
  const points = [...(known.length && low === 0 && known[0]!.gap > 0 && drawing.value!.gap > 0 ? [{ gap: 0, objective: 0 }] : []), ...known];
  const path = points.map((one, i) => `${i ? "L" : "M"}${x(one.gap).toFixed(1)} ${y(one.objective!).toFixed(1)}`).join("");
  const area = points.length > 1 ? `${path}L${x(points.at(-1)!.gap).toFixed(1)} ${HIGH - 4}L${x(points[0]!.gap).toFixed(1)} ${HIGH - 4}Z` : "";
  const free = solved.value.filter((one) => one.objective === null).map((one) => one.gap);
  const edge = lost.value ?? (free.length ? [known.filter((one) => one.gap < free[0]!).at(-1)?.gap ?? 0, free[0]!] : null);
  const now = valueBetween(solved.value, gap);
  const loose = edge !== null && gap >= edge[1]!;
  const exact = solved.value.some((one) => Math.abs(one.gap - gap) < 1e-9);
  return (
    <svg class="curve" width={width} height={HIGH} role="img" aria-label={curveWords(edge)}>
      <line class="axis" x1={PAD} x2={width - PAD} y1={HIGH - 4} y2={HIGH - 4} />
      {edge && x(edge[1]!) <= width && (
        <>
          <rect class="lost" x={x(edge[1]!)} width={Math.max(width - PAD - x(edge[1]!), 0)} y={8} height={HIGH - 12} />
          <rect class="between" x={x(edge[0]!)} width={Math.max(x(edge[1]!) - x(edge[0]!), 1.5)} y={8} height={HIGH - 12} />
          <text class="lostword" x={Math.min(x(edge[1]!) + 6, width - 78)} y={19}>comes free</text>
        </>
      )}
      {area && <path class="under" d={area} />}
      {path && <path class="line" d={path} />}
      {solved.value.filter((one) => one.gap <= most).map((one) => (
        <g key={one.gap}>
          <line class="tick" x1={x(one.gap)} x2={x(one.gap)} y1={HIGH - 7} y2={HIGH} />
          {one.objective !== null && <circle class="dot" cx={x(one.gap)} cy={y(one.objective)} r={2.4} />}
        </g>
      ))}
      {known.length > 0 && <text class="scale" x={PAD} y={10}>{number(high, 3)} {unitOf()}</text>}
      <line class="now" x1={x(gap)} x2={x(gap)} y1={6} y2={HIGH} />
      {now !== null && !loose && <circle class={exact ? "here" : "here guess"} cx={x(gap)} cy={Math.max(y(now), 4)} r={4.6} />}
      {answer.value === null && known.length === 0 && <text class="empty" x={width / 2} y={HIGH / 2}>motion against gap grows here</text>}
    </svg>
  );
}

/** Unit of the objective, as the answers say it. */
export function unitOf(): string {
  if (typeof design.value.goals === "string") return "mm²";
  if (goals.value.every(isPull)) return "mm";
  return goals.value.every(isTurn) ? "rad" : "";
}

function curveWords(edge: readonly (number | undefined)[] | null): string {
  const known = solved.value.map((one) => `${number(one.gap)}: ${one.objective === null ? "comes free" : number(one.objective)}`);
  return `largest motion against gap, mm: ${known.join("; ") || "nothing solved yet"}${edge ? `. Comes free between ${number(edge[0]!)} and ${number(edge[1]!)}` : ""}`;
}
