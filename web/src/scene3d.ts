/** Solids in a scene of three.js: light that comes with the eye, edges, marks of contacts, turning by hand and by keys. */

import {
  AmbientLight, ArrowHelper, BackSide, BufferAttribute, BufferGeometry, Color, DirectionalLight, EdgesGeometry, Group, LineBasicMaterial, LineSegments, type Material, Mesh,
  MeshBasicMaterial, MeshStandardMaterial, type PerspectiveCamera, type Plane, type Quaternion, Scene, SphereGeometry, Vector3, type WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { canvas3d } from "./canvas3d.ts";
import { boxCorners, framed } from "./frame3d.ts";
import type { Triple } from "./protocol.ts";
import type { Surface } from "./solids.ts";

const CREASE_DEGREES = 10;
/** Where the eye stands at first, from what it sees: at the front right, above. */
const EYE = new Vector3(1.25, -1.35, 0.98);
/** A view whose direction has this cosine with an axis is one along it. */
const ALONG = 0.9999;
const STEP = 0.12; // radians that a key turns

export interface Scene3d {
  renderer: WebGLRenderer;
  camera: PerspectiveCamera;
  world: Scene;
  controls: OrbitControls;
  /** Draws in the next frame. */
  ask(): void;
  /** Brings everything into the picture, seen from where it is seen now. */
  look(): void;
  /** The same, unless the hand has chosen another view since. */
  relook(): void;
  /** The same, where something has left the picture or all has become small in it. */
  keep(): void;
  /** Turns the view about what it looks at [rad]. */
  turn(sideways: number, upwards: number): void;
  /** Comes nearer by a factor. */
  zoom(factor: number): void;
  /** Looks at everything along an axis, from its positive side; where it does so already, from the other one. */
  along(axis: Vector3): void;
  /** Puts the eye somewhere, and says what it looks at. */
  put(eye: Vector3, target: Vector3): void;
  remove(): void;
}

/** A scene that fills `box`; `before` is called before every frame and says whether another one is wanted, `points` are to be in the picture. */
export function scene3d(box: HTMLElement, label: string, points: () => Vector3[], before: (now: number) => boolean = () => false): Scene3d {
  const { renderer, camera } = canvas3d(label);
  camera.position.copy(EYE);
  camera.lookAt(0, 0, 0);
  box.append(renderer.domElement);
  const world = new Scene();
  world.add(camera, new AmbientLight(0xffffff, 1.5));
  for (const [x, y, z, strong] of [[2, 1, 3, 1.8], [-3, 1, 1, 0.7]] as const) {
    const sun = new DirectionalLight(0xffffff, strong);
    sun.position.set(x, y, z);
    camera.add(sun);
  }
  const controls = new OrbitControls(camera, renderer.domElement);
  let wanted = 0;
  const draw = (now: number): void => {
    wanted = 0;
    const again = before(now);
    renderer.render(world, camera);
    if (again) ask();
  };
  const ask = (): void => {
    if (!wanted) wanted = requestAnimationFrame(draw);
  };
  controls.addEventListener("change", ask);
  /** Whether all is in the picture, until the hand moves the view: then it stays so when the box changes its size. */
  let looked = false;
  controls.addEventListener("start", () => (looked = false));
  const watch = new ResizeObserver(([entry]) => {
    const { width, height } = entry!.contentRect;
    if (!width || !height) return;
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    if (looked) look();
    ask();
  });
  watch.observe(box);
  function look(): void {
    looked = true;
    const { eye, target, reach } = framed(points(), camera);
    [camera.near, camera.far] = [reach / 300, reach * 100];
    camera.updateProjectionMatrix();
    controls.target.copy(target);
    camera.position.copy(eye);
    controls.update();
    ask();
  }
  function keep(): void {
    if (!looked) return;
    const all = points();
    const { eye, target } = framed(all, camera);
    camera.updateMatrixWorld();
    const out = all.some((point) => {
      const { x, y } = point.project(camera);
      return Math.max(Math.abs(x), Math.abs(y)) > 0.99;
    });
    if (out || camera.position.distanceTo(controls.target) > 1.4 * eye.distanceTo(target)) look();
  }
  return {
    renderer, camera, world, controls, ask, look, keep,
    relook: () => void (looked && look()),
    turn(sideways, upwards) {
      looked = false;
      const arm = camera.position.clone().sub(controls.target);
      const across = new Vector3().crossVectors(arm, camera.up).normalize();
      const steep = arm.angleTo(camera.up);
      const up = Math.min(Math.max(upwards, steep - Math.PI + 0.02), steep - 0.02);
      arm.applyAxisAngle(across, up).applyAxisAngle(camera.up, sideways);
      camera.position.copy(controls.target).add(arm);
      controls.update();
      ask();
    },
    zoom(factor) {
      looked = false;
      const arm = camera.position.clone().sub(controls.target).divideScalar(factor);
      if (arm.length() < 4 * camera.near || arm.length() > camera.far / 4) return;
      camera.position.copy(controls.target).add(arm);
      controls.update();
      ask();
    },
    along(axis) {
      const arm = camera.position.clone().sub(controls.target);
      const far = arm.length();
      camera.position.copy(controls.target).addScaledVector(axis, arm.dot(axis) > ALONG * far ? -far : far);
      controls.update();
      look();
    },
    put(eye, target) {
      looked = false;
      controls.target.copy(target);
      camera.position.copy(eye);
      controls.update();
      ask();
    },
    remove() {
      cancelAnimationFrame(wanted);
      watch.disconnect();
      controls.dispose();
      world.traverse((one) => {
        const { geometry, material } = one as { geometry?: BufferGeometry; material?: Material };
        geometry?.dispose();
        material?.dispose();
      });
      renderer.dispose();
      renderer.domElement.remove();
    },
  };
}

/** What an arrow key turns the view by, sideways and upwards [rad]; null for other keys. */
export function turnOfKey(key: string): [number, number] | null {
  return ({ ArrowLeft: [-STEP, 0], ArrowRight: [STEP, 0], ArrowUp: [0, STEP], ArrowDown: [0, -STEP] } as Record<string, [number, number]>)[key] ?? null;
}

export interface Shape3d { flat: BufferGeometry; edges: BufferGeometry }

/** Faces with normals of their own, and edges where faces meet at an angle. */
export function shape3d({ corners, triangles }: Surface): Shape3d {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return { flat, edges: new EdgesGeometry(geometry, CREASE_DEGREES) };
}

/** How much of the colour of its edges a cut face has. */
const CUT = 0.45;

/** A part: its faces and its edges, and its faces from within: in one even colour they look like the face where a plane cuts it. */
export class Solid3d extends Group {
  readonly body: Mesh<BufferGeometry, MeshStandardMaterial>;
  readonly inside: Mesh<BufferGeometry, MeshBasicMaterial>;
  readonly outline: LineSegments<BufferGeometry, LineBasicMaterial>;

  constructor({ flat, edges }: Shape3d) {
    super();
    this.body = new Mesh(flat, new MeshStandardMaterial({ roughness: 0.85, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
    this.inside = new Mesh(flat, new MeshBasicMaterial({ side: BackSide, polygonOffset: true, polygonOffsetFactor: -4, polygonOffsetUnits: -4 }));
    this.inside.visible = false;
    this.outline = new LineSegments(edges, new LineBasicMaterial());
    this.add(this.body, this.inside, this.outline);
  }

  /** Shows what lies on one side of planes alone. */
  cut(planes: Plane[]): void {
    for (const { material } of [this.body, this.inside, this.outline]) material.clippingPlanes = planes;
    this.inside.visible = planes.length > 0 && this.body.visible;
  }

  /** Corners of its own box, turned and moved. */
  boxCorners(turn: Quaternion, shift: Vector3): Vector3[] {
    const { geometry } = this.body;
    if (!geometry.boundingBox) geometry.computeBoundingBox();
    return boxCorners(geometry.boundingBox!, turn, shift);
  }

  paint(fill: string, edge: string): void {
    this.body.material.color.set(fill);
    this.inside.material.color.set(fill).lerp(new Color(edge), CUT);
    this.outline.material.color.set(edge);
  }
}

/** An arrow that is seen through everything. */
export function arrow3d(from: Vector3, direction: Vector3, long: number, colour: string, thick = 1): ArrowHelper {
  const arrow = new ArrowHelper(direction.clone().normalize(), from, long, colour, Math.min(long * 0.6, long * 0.18 * thick), Math.min(long * 0.4, long * 0.1 * thick));
  for (const piece of [arrow.line, arrow.cone]) {
    (piece.material as Material).depthTest = false;
    piece.renderOrder = 2;
  }
  return arrow;
}

/** A place where parts press on each other, and how hard. */
export function contact3d(point: readonly number[], normal: readonly number[], share: number, size: number, colour: string): Group {
  const at = new Vector3(...(point as Triple));
  const ball = new Mesh(new SphereGeometry(size * 0.008, 16, 12), new MeshStandardMaterial({ color: colour, depthTest: false }));
  ball.position.copy(at);
  ball.renderOrder = 2;
  return new Group().add(ball, arrow3d(at, new Vector3(...(normal as Triple)), size * (0.05 + 0.1 * share), colour));
}
