/** Parts in space on a page of their own: turned by hand, moved along their way, taken apart, with contacts. */

import {
  AmbientLight, ArrowHelper, BufferAttribute, BufferGeometry, Color, DirectionalLight, EdgesGeometry, Group, LineBasicMaterial, LineSegments, Mesh,
  MeshStandardMaterial, Quaternion, Scene, SphereGeometry, Vector3,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { canvas3d } from "./canvas3d.ts";
import { fromBase64 } from "./protocol.ts";

interface SolidPart {
  name: string;
  colour: [number, number, number];
  /** Corners about the reference point, float32 [mm]. */
  vertices: string;
  /** Triangles, uint32. */
  triangles: string;
  reference: [number, number, number];
}

interface SolidScene {
  parts: SolidPart[];
  /** When each way-point is reached, from 0 to 1. */
  times: number[];
  /** Way-points, parts: displacement [mm] and quaternion x, y, z, w, float32. */
  motions: string;
  contacts: { point: [number, number, number]; normal: [number, number, number]; share: number }[];
  centre: [number, number, number];
  size: number;
}

const CREASE_DEGREES = 10;
const SECONDS = 4;

function floats(text: string): Float32Array {
  return new Float32Array(fromBase64(text).buffer);
}

/** Index of the way-point before a time, and how far it is to the next. */
export function between(times: readonly number[], t: number): [number, number] {
  let k = 0;
  while (k < times.length - 2 && times[k + 1]! < t) k += 1;
  const span = (times[k + 1] ?? 1) - times[k]!;
  return [k, span > 0 ? Math.min(Math.max((t - times[k]!) / span, 0), 1) : 1];
}

function start(data: SolidScene): void {
  const box = document.getElementById("view")!;
  const slider = document.getElementById("way") as HTMLInputElement;
  const explode = document.getElementById("explode") as HTMLInputElement;
  const play = document.getElementById("play") as HTMLButtonElement;
  const { renderer, camera } = canvas3d("parts in 3D: drag or arrow keys turn them, the wheel comes nearer");
  box.append(renderer.domElement);
  const dark = matchMedia("(prefers-color-scheme: dark)").matches;
  [camera.near, camera.far] = [data.size / 500, data.size * 60];
  const centre = new Vector3(...data.centre);
  camera.position.copy(centre).add(new Vector3(1.25, -1.35, 0.98).multiplyScalar(1.35 * data.size));
  const world = new Scene();
  world.add(camera, new AmbientLight(0xffffff, 1.5));
  for (const [x, y, z, strong] of [[2, 1, 3, 1.8], [-3, 1, 1, 0.7]] as const) {
    const sun = new DirectionalLight(0xffffff, strong);
    sun.position.set(x, y, z);
    camera.add(sun);
  }
  const groups = data.parts.map((part) => {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(floats(part.vertices), 3));
    geometry.setIndex(new BufferAttribute(new Uint32Array(fromBase64(part.triangles).buffer), 1));
    const flat = geometry.toNonIndexed();
    flat.computeVertexNormals();
    const [r, g, b] = part.colour;
    const colour = new Color(`rgb(${r}, ${g}, ${b})`);
    const group = new Group();
    group.add(
      new Mesh(flat, new MeshStandardMaterial({ color: colour, roughness: 0.85, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 })),
      new LineSegments(new EdgesGeometry(geometry, CREASE_DEGREES), new LineBasicMaterial({ color: dark ? 0xd8dee6 : 0x26303a })),
    );
    world.add(group);
    return group;
  });
  const marks = new Group();
  for (const { point, normal, share } of data.contacts) {
    const at = new Vector3(...point);
    const ball = new Mesh(new SphereGeometry(data.size * 0.008, 16, 12), new MeshStandardMaterial({ color: 0xc1272d, depthTest: false }));
    ball.position.copy(at);
    ball.renderOrder = 2;
    const arrow = new ArrowHelper(new Vector3(...normal), at, data.size * (0.04 + 0.1 * share), 0xc1272d, data.size * 0.025, data.size * 0.014);
    for (const piece of [arrow.line, arrow.cone]) {
      (piece.material as LineBasicMaterial).depthTest = false;
      piece.renderOrder = 2;
    }
    marks.add(ball, arrow);
  }
  world.add(marks);
  const motions = floats(data.motions);
  const count = data.parts.length;
  const one = new Quaternion();
  const other = new Quaternion();

  /** Places the parts; positions go straight between way-points, turns about one constant axis. */
  function place(): void {
    const [k, share] = between(data.times, Number(slider.value));
    const apart = Number(explode.value);
    const next = Math.min(k + 1, data.times.length - 1);
    data.parts.forEach((part, p) => {
      const a = 7 * (k * count + p);
      const b = 7 * (next * count + p);
      one.fromArray(motions, a + 3);
      other.fromArray(motions, b + 3);
      groups[p]!.quaternion.copy(one).slerp(other, share);
      groups[p]!.position.set(
        ...([0, 1, 2].map((i) => {
          const moved = motions[a + i]! + share * (motions[b + i]! - motions[a + i]!);
          return part.reference[i]! + moved + apart * (part.reference[i]! - data.centre[i]!);
        }) as [number, number, number]),
      );
    });
    marks.visible = Number(slider.value) > 0.999 && apart < 0.01;
    ask();
  }

  const controls = new OrbitControls(camera, renderer.domElement);
  controls.target.copy(centre);
  let wanted = 0;
  function draw(): void {
    wanted = 0;
    renderer.render(world, camera);
  }
  function ask(): void {
    if (!wanted) wanted = requestAnimationFrame(draw);
  }
  controls.addEventListener("change", ask);
  renderer.domElement.addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, 0.12], ArrowDown: [0, -0.12] }[event.key];
    if (!turn) return;
    event.preventDefault();
    const arm = camera.position.clone().sub(centre).applyAxisAngle(camera.up, turn[0]!);
    arm.z += turn[1]! * data.size;
    camera.position.copy(centre).add(arm);
    controls.update();
    ask();
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
  explode.addEventListener("input", place);
  document.querySelectorAll<HTMLInputElement>("input[data-part]").forEach((tick) =>
    tick.addEventListener("change", () => {
      groups[Number(tick.dataset.part)]!.visible = tick.checked;
      ask();
    }),
  );
  new ResizeObserver(([entry]) => {
    const { width, height } = entry!.contentRect;
    if (!width || !height) return;
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    ask();
  }).observe(box);
  controls.update();
  place();
}

const given = typeof document === "undefined" ? null : document.getElementById("solid");
if (given?.textContent) start(JSON.parse(given.textContent) as SolidScene);
