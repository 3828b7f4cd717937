/** The gap: a slider that can play, a box, and above them the curve of the motion that grows with every gap that was solved. */

import { signal, useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { asks, design, goals, settle } from "../design.ts";
import { valueBetween } from "../motion.ts";
import { isTurn, isTwist } from "../protocol.ts";
import { ask, setGap } from "../session.ts";
import { answer, atStart, standalone, current, drawing, findings, lost, running, type Solved, solved } from "../state.ts";
import { nearestBy, number, ticks } from "../words.ts";
import { Button } from "./Button.tsx";
import { NumberBox } from "./NumberBox.tsx";
import { stepOf } from "./Selection.tsx";

/** A motion of less than this share of the largest gap is none. */
const NOTHING = 1e-6;
const HIGH = 92;
const LEFT = 58;
const RIGHT = 9; // half of the thumb: the curve stands exactly over the slider
const TOP = 12;
const FOOT = 18;

/** True while the gap goes up by itself, from solved answer to solved answer. */
const playing = signal(false);
const PAUSE = 90;
const STEPS = 24;

export function GapStrip() {
  const top = useSignal(0);
  const width = useSignal(0);
  const box = useRef<HTMLDivElement>(null);
  const opened = drawing.value;
  const gap = design.value.gap;
  useEffect(() => {
    top.value = opened ? firstTop(opened) : 0;
    playing.value = false;
  }, [opened]);
  useEffect(() => {
    if (!box.current) return;
    const watch = new ResizeObserver(([entry]) => (width.value = entry!.contentRect.width));
    watch.observe(box.current);
    return () => watch.disconnect();
  }, [opened === null]);
  const still = standalone.value !== null;
  const gaps = solved.value.map((one) => one.gap);
  const most = still ? Math.max(...gaps, 1e-9) : niceTop(Math.max(top.value, gap, ...gaps));
  const low = still ? Math.min(...gaps) : 0;
  const done = current(answer.value) && answer.value!.reply.settled;
  useEffect(() => {
    if (!playing.value || !(done || findings.value.length)) return;
    const timer = setTimeout(() => playOn(low, most), PAUSE);
    return () => clearTimeout(timer);
  }, [playing.value, done, gap, findings.value.length]);
  if (!opened || (still && solved.value.length < 2)) return null;
  const slider = still ? (most - low) / 400 || 1e-6 : stepOf(most / 30);
  return (
    <section class="gapstrip" inert={atStart.value} aria-label="gap">
      <div class="gapbox">
        <label for="gap">Gap</label>
        <NumberBox value={gap} min={0} step={gapStep()} unit="mm" label="gap" onChange={(value) => setGap(value, "")} disabled={still} />
        <div class="group">
          <Button
            icon={playing.value ? "pause" : "play"} label={playing.value ? "Stop the gap" : "Play the gap: solve one after the other"} class="small" disabled={!asks(design.value)}
            onClick={() => (playing.value ? (playing.value = false) : startPlaying(low, most))}
          />
          {!still && (
            <Button label="Solve a row of gaps" onClick={() => sweep(most)} disabled={!asks(design.value) || running.value.has("sweep")} class="small">
              {running.value.has("sweep") ? "Sweeping…" : "Sweep"}
            </Button>
          )}
        </div>
      </div>
      <div class="gapcurve" ref={box}>
        <Curve width={width.value} low={low} most={most} gap={gap} />
        <input
          id="gap" type="range" min={low} max={most} step={slider} value={gap} style={{ marginLeft: `${LEFT - RIGHT}px`, width: `calc(100% - ${LEFT - RIGHT}px)` }}
          aria-valuetext={`${number(gap)} mm`} onPointerDown={() => (playing.value = false)}
          onInput={(event) => setGap(slid(Number(event.currentTarget.value), most))} onPointerUp={settle} onBlur={settle}
        />
      </div>
    </section>
  );
}

/** By how much a key or an arrow of the box changes the gap [mm]; of a gap of 0 a share of the first scale of the slider. */
export function gapStep(): number {
  return stepOf(design.value.gap || niceTop(firstTop(drawing.value!)) / 10);
}

function startPlaying(low: number, most: number): void {
  playing.value = true;
  settle();
  if (design.peek().gap >= most * (1 - 1e-9)) setGap(standalone.peek() ? low : slid(most / STEPS, most), "play");
}

/** The next gap, or the end. */
function playOn(low: number, most: number): void {
  const now = design.peek().gap;
  const next = standalone.peek() ? solved.peek().find((one) => one.gap > now * (1 + 1e-9))?.gap : slid(now + (most - low) / STEPS, most);
  if (next === undefined || next > most * (1 + 1e-9) || next <= now || findings.peek().length) playing.value = false;
  else setGap(next, "play");
}

/** The slider gives round numbers, except on a standalone page, where only stored gaps have answers. */
function slid(value: number, most: number): number {
  const step = stepOf(most / 30);
  if (!standalone.value) return Number((Math.round(value / step) * step).toPrecision(6));
  return nearestBy(solved.value, (one) => one.gap, value)!.gap;
}

/** Solves a row of gaps, and the present one with what was found at smaller ones. */
function sweep(most: number): void {
  const own = design.peek().gap;
  const gaps = Array.from({ length: 10 }, (_, i) => Number(((most * (i + 1)) / 10).toPrecision(6))).filter((gap) => Math.abs(gap - own) > 1e-9);
  if (own > 0) gaps.push(own);
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
  if (width < 120) return <svg class="curve" height={HIGH} aria-hidden="true" />;
  const foot = HIGH - FOOT;
  const x = (g: number): number => LEFT + ((g - low) / Math.max(most - low, 1e-12)) * (width - LEFT - RIGHT);
  const inside = solved.value.filter((one) => one.gap <= most);
  const known = inside.filter((one) => one.objective !== null);
  const reached = Math.max(...known.map((one) => Math.max(one.objective!, one.atMost ?? 0)), 0);
  const high = reached > NOTHING * most ? reached : most; // what does not move has no scale of its own
  const y = (v: number): number => foot - (v / high) * (foot - TOP);
  const runs = connected(inside);
  const free = inside.filter((one) => one.objective === null).map((one) => one.gap);
  const edge = lost.value ?? (free.length ? [known.filter((one) => one.gap < free[0]!).at(-1)?.gap ?? free[0]!, free[0]!] : null);
  const now = valueBetween(solved.value, gap);
  const loose = edge !== null && gap >= edge[1]!;
  const exact = solved.value.some((one) => Math.abs(one.gap - gap) < 1e-9);
  return (
    <svg class="curve" width={width} height={HIGH} role="img" aria-label={curveWords(edge)}>
      {ticks(low, most, Math.max(2, Math.floor(width / 110))).map((g, i, all) => (
        <g key={g}>
          <line class="axis" x1={x(g)} x2={x(g)} y1={foot} y2={foot + 4} />
          <text class="scale" x={Math.min(x(g), width - 2)} y={HIGH - 2} text-anchor={x(g) > width - 40 ? "end" : "middle"}>{number(g, 3)}{i === all.length - 1 ? " mm gap" : ""}</text>
        </g>
      ))}
      {known.length > 0 && ticks(0, high, 3).map((v, i, all) => (
        <g key={v}>
          <line class="grid" x1={LEFT} x2={width - RIGHT} y1={y(v)} y2={y(v)} />
          <text class="scale" x={LEFT - 6} y={y(v) + 4} text-anchor="end">{number(v, 3)}{i === all.length - 1 ? ` ${unitOf()}` : ""}</text>
        </g>
      ))}
      <line class="axis" x1={LEFT} x2={width - RIGHT} y1={foot} y2={foot} />
      {edge && x(edge[1]!) <= width && (
        <>
          <rect class="lost" x={x(edge[1]!)} width={Math.max(width - RIGHT - x(edge[1]!), 0)} y={TOP} height={foot - TOP} />
          <rect class="between" x={x(edge[0]!)} width={Math.max(x(edge[1]!) - x(edge[0]!), 1.5)} y={TOP} height={foot - TOP} />
          <text class="lostword" x={Math.min(x(edge[1]!) + 6, width - 78)} y={TOP + 12}>comes free</text>
        </>
      )}
      {runs.map((run) => <path key={run[0]!.gap} class="line" d={run.map((one, i) => `${i ? "L" : "M"}${x(one.gap).toFixed(1)} ${y(one.objective!).toFixed(1)}`).join("")} />)}
      {runs.flatMap((run) => run.slice(1).map((one, i) => one.atMost != null && run[i]!.atMost != null && (
        <rect key={one.gap} class="band" x={x(run[i]!.gap)} width={x(one.gap) - x(run[i]!.gap)} y={y(one.atMost)} height={Math.max(y(run[i]!.objective!) - y(one.atMost), 0)} />
      )))}
      {known.filter((one) => one.atMost != null).map((one) => (
        <path key={one.gap} class="bound" d={`M${x(one.gap)} ${y(one.objective!)}V${y(one.atMost!)}M${x(one.gap) - 5} ${y(one.atMost!)}h10`}><title>proven: no motion exceeds {number(one.atMost!)}</title></path>
      ))}
      {inside.map((one) => (
        <g key={one.gap}>
          <line class="tick" x1={x(one.gap)} x2={x(one.gap)} y1={foot - 3} y2={foot + 3} />
          {one.objective !== null && <circle class={one.verdict === "proven" ? "dot proven" : "dot"} cx={x(one.gap)} cy={y(one.objective)} r={2.6} />}
        </g>
      ))}
      <line class="now" x1={x(gap)} x2={x(gap)} y1={6} y2={foot + 4} />
      {now !== null && !loose && exact && <circle class="here" cx={x(gap)} cy={Math.max(y(now), 4)} r={4.6} />}
      {known.length === 0 && !edge && <text class="empty" x={LEFT + (width - LEFT) / 2} y={HIGH / 2}>{width - LEFT < 220 ? "the curve grows here" : "motion against gap grows here"}</text>}
    </svg>
  );
}

/** Solved gaps in runs that nothing lies between at which parts come free. */
function connected(all: readonly Solved[]): Solved[][] {
  const runs: Solved[][] = [[]];
  for (const one of all) {
    if (one.objective === null) runs.push([]);
    else runs.at(-1)!.push(one);
  }
  return runs.filter((run) => run.length > 1);
}

/** Unit of the objective, as the answers say it. */
export function unitOf(): string {
  if (typeof design.value.goals === "string") return design.value.goals === "weight" ? "" : "mm²";
  if (goals.value.every((goal) => goal.direction)) return "mm";
  return goals.value.every((goal) => isTurn(goal) || isTwist(goal)) ? "rad" : "";
}

function curveWords(edge: readonly (number | undefined)[] | null): string {
  const known = solved.value.map((one) => `${number(one.gap)}: ${one.objective === null ? "comes free" : number(one.objective)}`);
  return `largest motion${unitOf() && `, ${unitOf()},`} against gap, mm: ${known.join("; ") || "nothing solved yet"}${edge ? `. Comes free ${edge[0] === edge[1] ? "at" : `between ${number(edge[0]!)} and`} ${number(edge[1]!)}` : ""}`;
}
