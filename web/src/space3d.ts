/** The free space of a pair in 3D. This file is the only one that knows three.js; it is loaded when it is first wanted. */

import {
  AmbientLight, BufferAttribute, BufferGeometry, DirectionalLight, DoubleSide, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, MeshStandardMaterial, PerspectiveCamera, PlaneGeometry, Scene, SphereGeometry, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { fromBase64, type SpaceReply } from "./protocol.ts";

export interface SpaceView {
  /** Moves the point to a relative motion [mm, mm, degrees]. */
  point(state: [number, number, number]): void;
  /** Moves the plane of the slice to a turn [degrees]. */
  slice(angle: number): void;
  remove(): void;
}

/** Outlines of the slices, one above the other. */
function contours(reply: SpaceReply, tall: (angle: number) => number): BufferGeometry {
  const ends: number[] = [];
  for (const { angle_deg, rings } of reply.slices) {
    const z = tall(angle_deg);
    for (const ring of rings) ring.forEach(([x, y], i) => ends.push(x, y, z, ...ring[(i + 1) % ring.length]!, z));
  }
  return new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(ends), 3));
}

/** Draws the region into `box`; turns are drawn upwards, times the scale of the reply. */
export function show(box: HTMLElement, reply: SpaceReply, dark: boolean): SpaceView {
  const renderer = new WebGLRenderer({ antialias: true, alpha: true });
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  box.replaceChildren(renderer.domElement);
  renderer.domElement.tabIndex = 0;
  const scene = new Scene();
  const camera = new PerspectiveCamera(32, 1, 0.001, 1000);
  camera.up.set(0, 0, 1);

  const geometry = new BufferGeometry();
  const corners = new Float32Array(fromBase64(reply.vertices).buffer);
  for (let i = 2; i < corners.length; i += 3) corners[i]! *= reply.scale; // degrees as mm
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  geometry.setIndex(new BufferAttribute(new Uint32Array(fromBase64(reply.triangles).buffer), 1));
  geometry.computeVertexNormals();
  geometry.computeBoundingBox();
  const bounds = geometry.boundingBox!;
  const middle = bounds.min.clone().add(bounds.max).multiplyScalar(0.5);
  const span = bounds.max.clone().sub(bounds.min);
  const unit = 1 / Math.max(span.x, span.y, span.z, 1e-9);
  const tall = (angle: number): number => angle * reply.scale;

  const body = new Mesh(geometry, new MeshStandardMaterial({
    color: dark ? 0x4f8fc7 : 0x6faadf, transparent: true, opacity: 0.62, flatShading: true, roughness: 1,
  }));
  const edges = new LineSegments(contours(reply, tall), new LineBasicMaterial({ color: dark ? 0xa8d1f5 : 0x1f5f99, transparent: true, opacity: 0.5 }));
  const plane = new Mesh(new PlaneGeometry(span.x * 1.15, span.y * 1.15), new MeshBasicMaterial({
    color: dark ? 0xffb04d : 0xc96a00, transparent: true, opacity: 0.2, side: DoubleSide, depthWrite: false,
  }));
  plane.position.set(middle.x, middle.y, middle.z);
  const dot = new Mesh(new SphereGeometry(0.022 / unit, 24, 16), new MeshBasicMaterial({ color: dark ? 0xffffff : 0x1f2933, depthTest: false }));
  dot.renderOrder = 2;
  for (const one of [body, edges, plane, dot]) scene.add(one);
  scene.scale.setScalar(unit);
  scene.position.copy(middle).multiplyScalar(-unit);
  scene.add(new AmbientLight(0xffffff, 2.3));
  const sun = new DirectionalLight(0xffffff, 0.9);
  sun.position.set(2, -3, 4);
  camera.add(sun);

  camera.position.set(1.5, -1.9, 1.25);
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.enablePan = false;
  let wanted = 0;
  const draw = (): void => {
    wanted = 0;
    renderer.render(world, camera);
  };
  const world = new Scene();
  world.add(scene, camera);
  const ask = (): void => {
    if (!wanted) wanted = requestAnimationFrame(draw);
  };
  controls.addEventListener("change", ask);
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
    point([x, y, angle]) {
      dot.position.set(x, y, tall(angle));
      ask();
    },
    slice(angle) {
      plane.position.z = tall(angle);
      ask();
    },
    remove() {
      watch.disconnect();
      controls.dispose();
      cancelAnimationFrame(wanted);
      for (const one of [body, edges, plane, dot]) {
        one.geometry.dispose();
        (one.material as MeshBasicMaterial).dispose();
      }
      renderer.dispose();
      renderer.forceContextLoss();
      box.replaceChildren();
    },
  };
}

(globalThis as { showSpace?: typeof show }).showSpace = show; // as one file without imports: on pages that carry it too
