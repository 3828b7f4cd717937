/** Parts in space on a page of their own: turned by hand, moved along their path, taken apart, with contacts. */

import { Group, Quaternion, Vector3 } from "three";
import { around } from "./frame3d.ts";
import { fromBase64, type Triple } from "./protocol.ts";
import { contact3d, scene3d, shape3d, Solid3d, turnOfKey } from "./scene3d.ts";

interface SolidPart {
  name: string;
  colour: Triple;
  /** Corners about the reference point, float32 [mm]. */
  vertices: string;
  /** Triangles, uint32. */
  triangles: string;
  reference: Triple;
  /** By how much it is set aside in the exploded view. */
  aside: Triple;
}

interface SolidScene {
  parts: SolidPart[];
  /** When each waypoint is reached, from 0 to 1. */
  times: number[];
  /** Waypoints, parts: displacement [mm] and quaternion x, y, z, w, float32. */
  motions: string;
  contacts: { point: Triple; normal: Triple; share: number }[];
  size: number;
}

const SECONDS = 4;

function floats(text: string): Float32Array {
  return new Float32Array(fromBase64(text).buffer);
}

/** Index of the waypoint before a time, and how far it is to the next. */
export function between(times: readonly number[], t: number): [number, number] {
  let k = 0;
  while (k < times.length - 2 && times[k + 1]! < t) k += 1;
  const span = (times[k + 1] ?? 1) - times[k]!;
  return [k, span > 0 ? Math.min(Math.max((t - times[k]!) / span, 0), 1) : 1];
}

function start(data: SolidScene): void {
  const box = document.getElementById("view")!;
  const slider = document.getElementById("path") as HTMLInputElement;
  const explode = document.getElementById("explode") as HTMLInputElement;
  const play = document.getElementById("play") as HTMLButtonElement;
  const solids: Solid3d[] = [];
  const view = scene3d(box, "parts in 3D: drag or arrow keys turn them, the wheel comes nearer", points);
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  for (const { vertices, triangles, colour } of data.parts) {
    const solid = new Solid3d(shape3d({ corners: floats(vertices), triangles: new Uint32Array(fromBase64(triangles).buffer) }));
    solid.paint(`rgb(${colour.join(", ")})`, dark ? "#d8dee6" : "#26303a");
    view.world.add(solid);
    solids.push(solid);
  }
  const marks = new Group();
  for (const { point, normal, share } of data.contacts) marks.add(contact3d(point, normal, share, data.size, "#c1272d"));
  view.world.add(marks);
  const motions = floats(data.motions);
  const count = data.parts.length;
  const one = new Quaternion();
  const other = new Quaternion();

  /** What is to be in the picture: all parts at rest and at the end of the path. */
  function points(): Vector3[] {
    const last = 7 * (data.times.length - 1) * count;
    const corners = (p: number, turn: Quaternion, shift: Vector3): Vector3[] => {
      const { reference, aside } = data.parts[p]!;
      const home = new Vector3(...reference).addScaledVector(new Vector3(...aside), Number(explode.value));
      return solids[p]!.boxCorners(turn, shift.add(home));
    };
    const rest = solids.flatMap((_, p) => corners(p, new Quaternion(), new Vector3()));
    return around(rest, solids.flatMap((_, p) => corners(p, new Quaternion().fromArray(motions, last + 7 * p + 3), new Vector3().fromArray(motions, last + 7 * p))));
  }

  /** Places the parts; positions go straight between waypoints, turns about one constant axis. */
  function place(): void {
    const [k, share] = between(data.times, Number(slider.value));
    const apart = Number(explode.value);
    const next = Math.min(k + 1, data.times.length - 1);
    data.parts.forEach((part, p) => {
      const a = 7 * (k * count + p);
      const b = 7 * (next * count + p);
      one.fromArray(motions, a + 3);
      other.fromArray(motions, b + 3);
      solids[p]!.quaternion.copy(one).slerp(other, share);
      solids[p]!.position.set(
        ...([0, 1, 2].map((i) => {
          const moved = motions[a + i]! + share * (motions[b + i]! - motions[a + i]!);
          return part.reference[i]! + moved + apart * part.aside[i]!;
        }) as Triple),
      );
    });
    marks.visible = Number(slider.value) > 0.999 && apart < 0.01;
    view.ask();
  }

  view.renderer.domElement.addEventListener("keydown", (event) => {
    const turn = turnOfKey(event.key);
    if (!turn) return;
    event.preventDefault();
    view.turn(...turn);
  });
  let began = 0;
  function step(now: number): void {
    if (!began) return;
    const t = (now - began) / (1000 * SECONDS);
    slider.value = String(Math.min(t, 1));
    place();
    if (t < 1) requestAnimationFrame(step);
    else stop();
  }
  function stop(): void {
    began = 0;
    play.textContent = "Play";
  }
  play.addEventListener("click", () => {
    if (began) return stop();
    began = performance.now() - (Number(slider.value) < 0.999 ? 1000 * SECONDS * Number(slider.value) : 0);
    play.textContent = "Stop";
    requestAnimationFrame(step);
  });
  slider.addEventListener("input", () => (stop(), place()));
  explode.addEventListener("input", () => (place(), view.relook()));
  document.querySelectorAll<HTMLInputElement>("input[data-part]").forEach((tick) =>
    tick.addEventListener("change", () => {
      solids[Number(tick.dataset.part)]!.visible = tick.checked;
      view.ask();
    }),
  );
  place();
  view.look();
}

const given = typeof document === "undefined" ? null : document.getElementById("solid");
if (given?.textContent) start(JSON.parse(given.textContent) as SolidScene);
