/** Free space of a pair in 3D (x, y, turn), with a slice of it and the present state as a point. */

import { useComputed, useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { design, fixedNames } from "../design.ts";
import { along, place, shown } from "../motion.ts";
import { ask } from "../session.ts";
import { isDark } from "../stage/colours.ts";
import { answer, standalone, current, drawing, extent, indexOf, names, selected, space } from "../state.ts";
import type { SpaceView } from "../space3d.ts";
import { nearestBy, number, short } from "../words.ts";
import { Run } from "../chrome/Run.tsx";
import { Command } from "./Command.tsx";
import { relative } from "./relative.ts";
import { Section } from "./Section.tsx";
import { Slice } from "./Slice.tsx";

export function Space() {
  const a = useSignal("");
  const b = useSignal("");
  const touching = useComputed(() => answer.value?.reply.contacts.map((one) => one.parts) ?? []);
  useEffect(() => {
    const chosen = selected.value;
    const pair = touching.value.find((one) => !chosen || one.includes(chosen));
    if (!a.value || (chosen && chosen !== a.value && chosen !== b.value)) {
      a.value = pair?.[0] ?? names.value[0] ?? "";
      b.value = pair?.[1] ?? names.value[1] ?? "";
      if (chosen && !pair) [a.value, b.value] = [names.value.find((name) => name !== chosen) ?? "", chosen];
      if (fixedNames.value.has(b.value) && !fixedNames.value.has(a.value)) [a.value, b.value] = [b.value, a.value];
    }
  }, [selected.value, touching.value]);
  const about = space.value;
  const choice = (one: typeof a, label: string) => (
    <label>{label} <input class="pairname" list="partnames" value={one.value} onChange={(event) => (one.value = event.currentTarget.value)} /></label>
  );
  const ready = indexOf.value.has(a.value) && indexOf.value.has(b.value) && a.value !== b.value;
  return (
    <Section title="Free space of a pair">
      <p>Everywhere one part can go against another: shift in x and y, and turn upwards.</p>
      {!standalone.value && (
        <div class="asks">
          <datalist id="partnames">{names.value.map((name) => <option key={name} value={name} />)}</datalist>
          {choice(a, "stands")}{choice(b, "moves")}
          <Run kind="space" label="Show the free space" onClick={() => void ask("space", { design: design.peek(), a: a.value, b: b.value })} disabled={!ready}>Show</Run>
        </div>
      )}
      {about && !current(about) && !standalone.value && <p class="quiet">shown for an earlier design</p>}
      {about?.reply.open && <p class="strong">{about.reply.words}</p>}
      {about && !about.reply.open && <Body />}
      {about && standalone.value && <Command text={about.reply.command} />}
    </Section>
  );
}

type Show = typeof import("../space3d.ts").show;
const here = globalThis as { showSpace?: Show };

/** The 3D view: in the page already where that carries a free space, else loaded now. */
async function viewer(): Promise<Show> {
  if (!here.showSpace) await import("./space-view.js" as string);
  return here.showSpace!;
}

/** What is smaller is left of rounding: a shift as a share of the drawing's radius, a turn in degrees. */
const NO_SHIFT = 1e-6;
const NO_TURN = 1e-4;

function nearest(slices: { angle_deg: number }[], angle: number): number {
  return slices.indexOf(nearestBy(slices, (one) => one.angle_deg, angle)!);
}

function Body() {
  const about = space.value!;
  const box = useRef<HTMLDivElement>(null);
  const made = useRef<SpaceView | null>(null);
  const which = useSignal(0);
  const failed = useSignal("");
  const { a, b, slices } = about.reply;
  const parts = drawing.value!.parts;
  const frames = shown.value.frames;
  const now = standalone.value !== null || current(about); // else the parts are in another free space
  const state = now && frames && frames.n === parts.length ? relative(parts, a, b, along(frames, place.value * (shown.value.until ?? 1)), about.reply.pivot) : about.reply.state;
  useEffect(() => {
    let gone = false;
    which.value = nearest(slices, state[2]);
    viewer().then(
      (show) => {
        if (gone || !box.current) return;
        made.current = show(box.current, about.reply, isDark(), (angle) => (which.value = nearest(slices, angle)));
        made.current.point(now ? state : null);
        made.current.slice(slices[which.peek()]?.angle_deg ?? 0);
      },
      () => (failed.value = "The 3D view could not be loaded."),
    );
    return () => {
      gone = true;
      made.current?.remove();
      made.current = null;
    };
  }, [about, isDark()]);
  useEffect(() => made.current?.point(now ? state : null));
  useEffect(() => made.current?.slice(slices[which.value]?.angle_deg ?? 0), [which.value]);
  const slice = slices[which.value];
  const shift = NO_SHIFT * extent.value.radius;
  const plain = (value: number, least: number): string => number(Math.abs(value) < least ? 0 : value, 3);
  return (
    <>
      {!standalone.value && <p class="strong pair">{short(b)} against {short(a)}</p>}
      <div class="space3d" ref={box} role="group" aria-label={`free space of ${b} against ${a}, turns from ${number(about.reply.range_deg[0], 3)} to ${number(about.reply.range_deg[1], 3)} degrees`} />
      {failed.value && <p class="quiet">{failed.value}</p>}
      {now && <p class="quiet now">now: {plain(state[0], shift)}, {plain(state[1], shift)} mm, {plain(state[2], NO_TURN)}°</p>}
      {slice && (
        <>
          <label class="slicer">slice at {number(slice.angle_deg, 3)}°
            <input type="range" min={0} max={slices.length - 1} value={which.value} aria-valuetext={`${number(slice.angle_deg, 3)} degrees`} onInput={(event) => (which.value = Number(event.currentTarget.value))} />
          </label>
          <Slice slices={slices} which={which.value} state={now ? state : null} here={which.value === nearest(slices, state[2])} />
          {slice.rings.length === 0 || which.value === 0 || which.value === slices.length - 1 ? <p class="quiet">The free space ends at this turn: hardly more than a point is left.</p> : null}
        </>
      )}
    </>
  );
}
