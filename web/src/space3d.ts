/** The free space of a pair in 3D; loaded, and three.js with it, when it is first wanted. */

import {
  AmbientLight, BufferAttribute, BufferGeometry, CanvasTexture, DirectionalLight, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh,
  MeshStandardMaterial, type Object3D, Raycaster, Scene, SphereGeometry, Sprite, SpriteMaterial, SRGBColorSpace, Vector2,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import { canvas3d } from "./canvas3d.ts";
import { fromBase64, type SpaceReply } from "./protocol.ts";
import { nearestBy, number, ticks } from "./words.ts";

export interface SpaceView {
  /** Moves the point to a relative motion [mm, mm, degrees]; takes it away where there is none. */
  point(state: [number, number, number] | null): void;
  /** Shows the slice at a turn [degrees]. */
  slice(angle: number): void;
  remove(): void;
}

type Slice = SpaceReply["slices"][number];
/** Sharper edges than this [rad] stay edges; what is flatter is shaded smoothly. */
const CREASE = 0.6;
const TEXT = 44;

/** Outlines of slices as line segments, each at its height. */
function contours(slices: readonly Slice[], tall: (angle: number) => number): BufferGeometry {
  const ends: number[] = [];
  for (const { angle_deg, rings } of slices) {
    const z = tall(angle_deg);
    for (const ring of rings) ring.forEach(([x, y], i) => ends.push(x, y, z, ...ring[(i + 1) % ring.length]!, z));
  }
  return new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(ends), 3));
}

function segments(ends: readonly number[]): BufferGeometry {
  return new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(ends), 3));
}

/** Words that always face the eye, `high` in the units of the scene. */
function label(words: string, high: number, colour: string): Sprite {
  const canvas = document.createElement("canvas");
  const g = canvas.getContext("2d")!;
  const font = `500 ${TEXT}px system-ui, sans-serif`;
  g.font = font;
  canvas.width = Math.ceil(g.measureText(words).width) + 12;
  canvas.height = TEXT + 16;
  g.font = font;
  g.fillStyle = colour;
  g.textBaseline = "middle";
  g.fillText(words, 6, canvas.height / 2);
  const map = new CanvasTexture(canvas);
  map.colorSpace = SRGBColorSpace; // else it is shown too pale
  const sprite = new Sprite(new SpriteMaterial({ map, depthTest: false, transparent: true }));
  sprite.scale.set((high * canvas.width) / canvas.height, high, 1);
  return sprite;
}

/** Draws the region into `box`; turns are drawn upwards, times the scale of the reply. `onAngle` is told the turn under the pointer. */
export function show(box: HTMLElement, reply: SpaceReply, dark: boolean, onAngle: (angle: number) => void = () => {}): SpaceView {
  const { renderer, camera } = canvas3d("free space in 3D: arrow keys turn it");
  box.replaceChildren(renderer.domElement);
  const [ink, quiet, accent] = dark ? [0xe8edf2, 0x6d7987, 0xffb04d] : [0x1f2933, 0xa9b3bd, 0xa85800];

  const tall = (angle: number): number => angle * reply.scale; // degrees as mm
  const raw = new BufferGeometry();
  const corners = new Float32Array(fromBase64(reply.vertices).buffer);
  for (let i = 2; i < corners.length; i += 3) corners[i]! *= reply.scale;
  raw.setAttribute("position", new BufferAttribute(corners, 3));
  raw.setIndex(new BufferAttribute(new Uint32Array(fromBase64(reply.triangles).buffer), 1));
  const geometry = toCreasedNormals(raw, CREASE);
  geometry.computeBoundingBox();
  const { min, max } = geometry.boundingBox!;
  const middle = min.clone().add(max).multiplyScalar(0.5);
  const span = max.clone().sub(min);
  const unit = 1 / Math.max(span.x, span.y, span.z, 1e-9);

  const body = new Mesh(geometry, new MeshStandardMaterial({
    color: dark ? 0x4f8fc7 : 0x7fb4e6, transparent: true, opacity: 0.78, roughness: 0.85, side: DoubleSide,
  }));
  const every = Math.max(1, Math.round(reply.slices.length / 10));
  const some = reply.slices.filter((_, k) => k % every === 0 || k === reply.slices.length - 1);
  const edges = new LineSegments(contours(some, tall), new LineBasicMaterial({ color: dark ? 0xa8d1f5 : 0x1f5f99, transparent: true, opacity: 0.45 }));
  const cut = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: accent, depthTest: false }));
  cut.renderOrder = 1;
  const dot = new Mesh(new SphereGeometry(0.02 / unit, 24, 16), new MeshStandardMaterial({ color: ink, emissive: ink, depthTest: false }));
  dot.renderOrder = 2;
  const scene = new Group();
  scene.add(body, edges, cut, dot, axes());
  scene.scale.setScalar(unit);
  scene.position.copy(middle).multiplyScalar(-unit);
  const world = new Scene();
  world.add(scene, camera, new AmbientLight(0xffffff, 1.7));
  for (const [x, y, z, strong] of [[2, 1, 3, 1.9], [-3, 1, 1, 0.7]] as const) {
    const sun = new DirectionalLight(0xffffff, strong);
    sun.position.set(x, y, z);
    camera.add(sun);
  }

  /** Three edges of the box with round numbers: x and y in mm, the turn in degrees. */
  function axes(): Group {
    const found = new Group();
    const pad = 0.06 / unit;
    const [x0, y0, z0, x1, y1, z1] = [min.x - pad, min.y - pad, min.z, max.x + pad, max.y + pad, max.z];
    const lines = [x0, y0, z0, x1, y0, z0, x1, y0, z0, x1, y1, z0, x0, y0, z0, x0, y0, z1];
    const words = dark ? "#c5ced8" : "#3d4854";
    const high = 0.08 / unit;
    const put = (text: string, x: number, y: number, z: number, larger = 1): void => {
      const one = label(text, high * larger, words);
      one.position.set(x, y, z);
      found.add(one);
    };
    const tick = 0.02 / unit;
    for (const x of ticks(min.x, max.x, 3)) {
      lines.push(x, y0, z0, x, y0 - tick, z0);
      put(number(x, 3), x, y0 - 3.2 * tick, z0);
    }
    for (const y of ticks(min.y, max.y, 3)) {
      lines.push(x1, y, z0, x1 + tick, y, z0);
      put(number(y, 3), x1 + 3.2 * tick, y, z0);
    }
    for (const angle of ticks(min.z / reply.scale, max.z / reply.scale, 5)) {
      const z = tall(angle);
      lines.push(x0, y0, z, x0 - tick, y0 - tick, z);
      put(`${number(angle, 3)}°`, x0 - 3 * tick, y0 - 3 * tick, z);
    }
    put("x mm", (x0 + x1) / 2, y0 - 9.5 * tick, z0, 1.15);
    put("y mm", x1 + 9 * tick, (y0 + y1) / 2, z0, 1.15);
    put("turn", x0 - 3 * tick, y0 - 3 * tick, z1 + 4 * tick, 1.15);
    found.add(new LineSegments(segments(lines), new LineBasicMaterial({ color: quiet })));
    return found;
  }

  camera.position.set(2.1, -2.65, 1.45);
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.enablePan = false;
  let wanted = 0;
  const draw = (): void => {
    wanted = 0;
    renderer.render(world, camera);
  };
  const ask = (): void => {
    if (!wanted) wanted = requestAnimationFrame(draw);
  };
  controls.addEventListener("change", ask);
  const ray = new Raycaster();
  const follow = (event: PointerEvent): void => {
    if (event.buttons) return; // it is being turned
    const { left, top, width, height } = renderer.domElement.getBoundingClientRect();
    ray.setFromCamera(new Vector2(((event.clientX - left) / width) * 2 - 1, 1 - ((event.clientY - top) / height) * 2), camera);
    const hit = ray.intersectObject(body)[0];
    if (hit) onAngle(scene.worldToLocal(hit.point).z / reply.scale);
  };
  renderer.domElement.addEventListener("pointermove", follow);
  const keys = (event: KeyboardEvent): void => {
    const turn = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    if (!turn) return;
    event.preventDefault();
    event.stopPropagation();
    camera.position.applyAxisAngle(camera.up, turn[0]!);
    camera.position.z += turn[1]! * 2;
    controls.update();
    ask();
  };
  renderer.domElement.addEventListener("keydown", keys);
  const watch = new ResizeObserver(([entry]) => {
    const { width, height } = entry!.contentRect;
    if (!width || !height) return;
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    ask();
  });
  watch.observe(box);
  controls.update();
  ask();
  return {
    point(state) {
      dot.visible = state !== null;
      if (state) dot.position.set(state[0], state[1], tall(state[2]));
      ask();
    },
    slice(angle) {
      const one = nearestBy(reply.slices, (slice) => slice.angle_deg, angle);
      cut.geometry.dispose();
      cut.geometry = contours(one ? [one] : [], tall);
      ask();
    },
    remove() {
      watch.disconnect();
      controls.dispose();
      cancelAnimationFrame(wanted);
      raw.dispose();
      scene.traverse(release);
      renderer.dispose();
      renderer.forceContextLoss();
      box.replaceChildren();
    },
  };
}

function release(one: Object3D): void {
  const { geometry, material } = one as Partial<Mesh>;
  geometry?.dispose();
  for (const each of material ? [material].flat() : []) {
    (each as SpriteMaterial).map?.dispose();
    each.dispose();
  }
}

(globalThis as { showSpace?: typeof show }).showSpace = show; // as one file without imports: on pages that carry it too
