/** The live parts in space: shown as they move, chosen and dragged by hand. Loaded, and three.js with it, when such a file is opened. */

import { ArrowHelper, BufferGeometry, Group, Line, LineBasicMaterial, Matrix4, Plane, Quaternion, Raycaster, Vector2, Vector3 } from "three";
import type { ContactEntry, Goal, Solids, Triple } from "./protocol.ts";
import { around } from "./frame3d.ts";
import { arrow3d, contact3d, scene3d, shape3d, Solid3d } from "./scene3d.ts";
import { boxOf, surfacesOf } from "./solids.ts";

/** How a part looks; `see` outlines it alone, so that one sees past it. */
export interface Look { name: string; fill: string; edge: string; see: boolean }
/** What is marked on the parts, as they are drawn. */
export interface Marks { contacts: readonly ContactEntry[]; goals: readonly Goal[]; highlit: readonly number[] | null }
/** A plane across an axis that cuts off what lies between it and the eye, at a share of the way through all parts. */
export interface Section { axis: 0 | 1 | 2; at: number }
/** Where the eye stands and what it looks at, from the middle of the parts [mm]. */
export interface Eye { at: Triple; target: Triple }
export interface Colours3d { force: string; motion: string; ghost: string; axes: [string, string, string] }

export interface Hand {
  /** Motions of all parts (7 numbers each), and whether they go on changing. */
  pose(now: number): { motion: Float32Array; moving: boolean };
  /** Where what is shown ends; null where all is at rest. */
  end(): Float32Array | null;
  /** Motions on the way there. */
  film(): readonly Float32Array[];
  /** How many times motions are enlarged. */
  factor(): number;
  exploded(): number;
  section(): Section | null;
  marks(): Marks | null;
  /** Whether a part may be dragged. */
  free(part: number): boolean;
  hover(part: number | null): void;
  choose(part: number | null): void;
  /** A contact was pressed. */
  joint(parts: readonly [string, string]): void;
  /** What can be done with a part, or with the ground, is wanted at a place of the window. */
  menu(part: number | null, at: { x: number; y: number }): void;
  drag(part: number, grip: Triple, target: Triple): void;
  release(): void;
  /** The view was moved. */
  seen(eye: Eye): void;
}

export interface SolidView {
  solids(solids: Solids): void;
  looks(looks: readonly Look[], colours: Colours3d): void;
  /** Draws again. */
  ask(): void;
  fit(): void;
  /** Brings what has left the picture into it, unless the hand has chosen the view. */
  keepFitted(): void;
  zoom(factor: number): void;
  turn(sideways: number, upwards: number): void;
  /** Looks along x, y or z; again from the other side. */
  along(axis: number): void;
  /** Looks from elsewhere. */
  see(eye: Eye): void;
  /** A step in the plane of the picture, of so many pixels, at a part's reference point [mm]. */
  across(part: number, right: number, up: number): Triple;
  remove(): void;
}

/** Further than this with the pointer down is a drag [px]. */
const SLACK = { mouse: 4, touch: 8 };
const AXIS = 34; // pixels
/** A contact is pressed within this distance of its foot [px]. */
const NEAR = { mouse: 9, touch: 16 };
/** Length of arrows of what is asked, as a share of the assembly's longest side. */
const ARROW = 0.34;
/** Parts that are set aside further carry no marks. */
const APART = 0.01;

/** Parts fill `box`; `hand` says how they lie and hears what is done to them. */
export function openStage(box: HTMLElement, label: string, hand: Hand): SolidView {
  const view = scene3d(box, label, points, before);
  const { camera, controls, world } = view;
  const canvas = view.renderer.domElement;
  view.renderer.localClippingEnabled = true;
  let given: Solids | null = null;
  /** Middle of the parts at rest, and how far they reach to both sides of it. */
  const middle = new Vector3();
  const half = new Vector3();
  /** What is cut off: none, or one plane. */
  let planes: Plane[] = [];
  let parts: Solid3d[] = [];
  let size = 1;
  let exploded = 0;
  let fresh = false;
  let colours: Colours3d = { force: "#c96a00", motion: "#0b3c6f", ghost: "#1f5f99", axes: ["#a02c22", "#2a6b4a", "#1f5f99"] };
  let ghost: Line | Group | null = null;
  const marks = new Group();
  world.add(marks);
  /** Where contacts are marked. */
  let spots: { at: Vector3; parts: [string, string] }[] = [];
  /** What the marks were made of, and whether the parts moved in the frame before: turning the view makes none anew. */
  let marked: unknown[] = [];
  let wasMoving = false;
  const along = (axis: number): void => view.along(new Vector3().setComponent(axis, 1));
  const axes = axesIn(box, along);

  /** Places the parts for a frame. */
  function before(now: number): boolean {
    if (!given) return false;
    const { motion, moving } = hand.pose(now);
    const factor = hand.factor();
    const apart = hand.exploded();
    parts.forEach((part, p) => {
      const [shift, turn] = moved(motion, p, factor);
      part.quaternion.copy(turn);
      part.position.copy(shift).add(home(p)).add(aside(p, apart));
    });
    if (fresh) view.look();
    else if (apart !== exploded) view.look();
    [fresh, exploded] = [false, apart];
    section();
    const told = hand.marks();
    const of = [told?.contacts, told?.goals, told?.highlit, factor, apart, colours, given, names];
    if (moving || wasMoving || of.some((one, k) => one !== marked[k])) renewMarks(told, motion, factor, apart);
    marked = of;
    wasMoving = moving;
    axes.draw(camera.quaternion, colours.axes);
    if (held?.moved) showGhost(held);
    return moving;
  }

  /** Cuts the parts as the hand wants it. */
  function section(): void {
    const wanted = hand.section();
    if (wanted) {
      const axis = new Vector3().setComponent(wanted.axis, 1);
      const at = middle.clone().addScaledVector(axis, (2 * wanted.at - 1) * half.getComponent(wanted.axis));
      if (camera.position.clone().sub(at).dot(axis) > 0) axis.negate();
      planes = [new Plane().setFromNormalAndCoplanarPoint(axis, at)];
    } else planes = [];
    for (const part of parts) part.cut(planes);
  }

  /** Enlarged displacement and turn of a part. */
  function moved(motion: Float32Array, p: number, factor: number): [Vector3, Quaternion] {
    const shift = new Vector3().fromArray(motion, 7 * p).multiplyScalar(factor);
    const turn = new Quaternion().fromArray(motion, 7 * p + 3).normalize();
    if (factor === 1) return [shift, turn];
    if (turn.w < 0) turn.set(-turn.x, -turn.y, -turn.z, -turn.w);
    const axis = new Vector3(turn.x, turn.y, turn.z);
    const angle = 2 * Math.atan2(axis.length(), turn.w);
    return [shift, angle > 0 ? new Quaternion().setFromAxisAngle(axis.normalize(), angle * factor) : turn];
  }
  const home = (p: number): Vector3 => new Vector3(...given!.reference[p]!);
  /** How far a part is set aside in the exploded view. */
  const aside = (p: number, apart: number): Vector3 => new Vector3(...given!.aside[p]!).multiplyScalar(apart);

  /** What is to be in the picture: all parts at rest, where what is shown ends, and the arrows there. */
  function points(): Vector3[] {
    const apart = hand.exploded();
    const motion = hand.end();
    const factor = hand.factor();
    const rest = parts.flatMap((part, p) => part.boxCorners(new Quaternion(), home(p).add(aside(p, apart))));
    if (!motion) return rest;
    const end = hand.film().flatMap((one) => parts.flatMap((part, p) => {
      const [shift, turn] = moved(one, p, factor);
      return part.boxCorners(turn, shift.add(home(p)).add(aside(p, apart)));
    }));
    const heads = apart > APART ? [] : asked(hand.marks()?.goals ?? [], motion, factor).map(({ at, along }) => at.addScaledVector(along, size * ARROW));
    return around(rest, [...end, ...heads]);
  }

  /** Where the arrows of what is asked stand and which way they point. */
  function asked(goals: readonly Goal[], motion: Float32Array, factor: number): { at: Vector3; along: Vector3; goal: Goal }[] {
    return goals.slice(0, 20).flatMap((goal) => {
      const p = indexOf(goal.part);
      const along = goal.direction ?? (typeof goal.turn === "string" ? null : goal.turn);
      if (p < 0 || along?.length !== 3) return [];
      const [wide, spun] = moved(motion, p, factor);
      const grip = goal.point?.length === 3 ? new Vector3(...(goal.point as Triple)).sub(home(p)) : new Vector3();
      return [{ at: grip.applyQuaternion(spun).add(home(p)).add(wide), along: new Vector3(...(along as Triple)).normalize(), goal }];
    });
  }

  function renewMarks(told: Marks | null, motion: Float32Array, factor: number, apart: number): void {
    drop(marks);
    spots = [];
    if (!told || apart > APART) return;
    const strongest = Math.max(...told.contacts.map((one) => one.force), 1e-300);
    for (const { parts: names, point, normal, force } of told.contacts.slice(0, 60)) {
      const p = told.contacts.length ? indexOf(names[1]) : -1;
      if (p < 0) continue;
      const [shift, turn] = moved(motion, p, 1);
      const [wide, spun] = moved(motion, p, factor);
      const local = new Vector3(...(point as Triple)).sub(home(p)).sub(shift).applyQuaternion(turn.clone().invert());
      const at = local.applyQuaternion(spun).add(home(p)).add(wide);
      const lit = told.highlit === point;
      spots.push({ at, parts: names as [string, string] });
      marks.add(contact3d(at.toArray(), normal, lit ? 1.6 : force / strongest, lit ? 1.4 * size : size, colours.force));
    }
    for (const { at, along, goal } of asked(told.goals, motion, factor)) {
      const arrow = arrow3d(at, along, size * ARROW, colours.motion, 1.1);
      marks.add(arrow);
      if (goal.turn) marks.add(round(at, arrow, size * 0.12));
    }
  }
  /** A ring with a head about an arrow: the twist that is asked for, right hand. */
  function round(at: Vector3, about: ArrowHelper, radius: number): Group {
    const points = Array.from({ length: 33 }, (_, i) => new Vector3(Math.cos((i / 32) * 5), 0, -Math.sin((i / 32) * 5)).multiplyScalar(radius));
    const line = new Line(new BufferGeometry().setFromPoints(points), new LineBasicMaterial({ color: colours.motion, depthTest: false }));
    line.renderOrder = 2;
    const last = points.at(-1)!;
    const head = arrow3d(last, last.clone().sub(points.at(-2)!), radius * 0.5, colours.motion, 3);
    const ring = new Group().add(line, head);
    ring.position.copy(at);
    ring.quaternion.copy(about.quaternion);
    return ring;
  }
  const indexOf = (name: string): number => names.indexOf(name);
  let names: string[] = [];

  interface Held { pointer: number; part: number | null; from: Vector2; moved: boolean; grip: Triple; base: Vector3; plane: Plane; offset: Vector3; target: Triple; factor: number; still: { position: Vector3; quaternion: Quaternion } }
  let held: Held | null = null;
  const caster = new Raycaster();

  const spot = ({ clientX, clientY }: MouseEvent): Vector2 => {
    const frame = canvas.getBoundingClientRect();
    return new Vector2(((clientX - frame.left) / frame.width) * 2 - 1, 1 - ((clientY - frame.top) / frame.height) * 2);
  };
  function under(event: MouseEvent): { part: number; at: Vector3 } | null {
    caster.setFromCamera(spot(event), camera);
    const shown = parts.filter((one) => one.visible && !one.userData.see).flatMap((one) => (planes.length ? [one.body, one.inside] : [one.body]));
    const hit = caster.intersectObjects(shown, false).find(({ point }) => planes.every((plane) => plane.distanceToPoint(point) >= 0));
    if (!hit) return null;
    const part = hit.object.parent as Solid3d;
    // a face seen from within: what is pressed is the cut before it
    const at = hit.object === part.inside ? caster.ray.intersectPlane(planes[0]!, new Vector3()) ?? hit.point : hit.point;
    return { part: parts.indexOf(part), at };
  }
  /** The joint whose contact is marked where the pointer is. */
  function jointAt(event: PointerEvent): [string, string] | null {
    const frame = canvas.getBoundingClientRect();
    const far = ({ at }: { at: Vector3 }): number => {
      const { x, y } = at.clone().project(camera);
      return Math.hypot(((x + 1) / 2) * frame.width - event.clientX + frame.left, ((1 - y) / 2) * frame.height - event.clientY + frame.top);
    };
    const [best] = spots.map((one) => ({ ...one, far: far(one) })).sort((a, b) => a.far - b.far);
    return best && best.far <= (event.pointerType === "touch" ? NEAR.touch : NEAR.mouse) ? best.parts : null;
  }
  /** Where the second button went down: it moves the view, and opens what can be done where it does not move. */
  let second: Vector2 | null = null;
  function press(event: PointerEvent): void {
    if (event.button === 2) second = new Vector2(event.clientX, event.clientY);
    if (held || event.button !== 0 || !event.isPrimary) {
      if (held && !held.moved) { // a second finger: it was to move the view
        held = null;
        controls.enabled = true;
      }
      return;
    }
    const found = under(event);
    const still = new Vector3();
    const one = found ? parts[found.part]! : null;
    held = {
      pointer: event.pointerId, part: found?.part ?? null, from: new Vector2(event.clientX, event.clientY), moved: false, grip: [0, 0, 0], base: still, plane: new Plane(),
      offset: new Vector3(), target: [0, 0, 0], factor: 1, still: { position: one?.position.clone() ?? new Vector3(), quaternion: one?.quaternion.clone() ?? new Quaternion() },
    };
    if (!found || !hand.free(found.part)) return;
    controls.enabled = false; // the hand has a part, not the view
    const local = found.at.clone().applyMatrix4(new Matrix4().copy(one!.matrixWorld).invert());
    held.grip = local.add(home(found.part)).toArray() as Triple;
    held.base = found.at.clone();
    held.offset = aside(found.part, hand.exploded());
    held.factor = hand.factor();
    held.plane.setFromNormalAndCoplanarPoint(camera.getWorldDirection(new Vector3()), found.at);
    canvas.setPointerCapture(event.pointerId);
  }
  function move(event: PointerEvent): void {
    if (!held) {
      if (event.pointerType !== "touch" && event.buttons === 0) hand.hover(under(event)?.part ?? null);
      return;
    }
    if (event.pointerId !== held.pointer) return;
    const far = held.from.distanceTo(new Vector2(event.clientX, event.clientY));
    if (!held.moved && far < (event.pointerType === "touch" ? SLACK.touch : SLACK.mouse)) return;
    held.moved = true;
    if (controls.enabled || held.part === null) return;
    caster.setFromCamera(spot(event), camera);
    const at = caster.ray.intersectPlane(held.plane, new Vector3());
    if (!at) return;
    const rest = new Vector3(...held.grip);
    held.target = at.clone().sub(held.offset).sub(rest).divideScalar(held.factor).add(rest).toArray() as Triple;
    held.base = at;
    hand.drag(held.part, held.grip, held.target);
    view.ask();
  }
  function lift(event: PointerEvent): void {
    if (event.button === 2 && second) {
      const { x, y } = second;
      if (event.type === "pointerup" && Math.hypot(event.clientX - x, event.clientY - y) < SLACK.mouse) hand.menu(under(event)?.part ?? null, { x, y });
      second = null;
    }
    if (!held || event.pointerId !== held.pointer) return;
    const { part, moved } = held;
    const dragged = !controls.enabled;
    held = null;
    hideGhost();
    controls.enabled = true;
    if (dragged && moved) hand.release();
    else if (!moved && event.type === "pointerup") {
      const joint = jointAt(event);
      if (joint) hand.joint(joint);
      else hand.choose(part);
    }
    view.ask();
  }
  /** Where the hand wants the part: its edges alone, for nothing is known about it yet. */
  function showGhost(now: Held): void {
    if (now.part === null || controls.enabled) return;
    const one = parts[now.part]!;
    if (!ghost) {
      const edges = one.outline.clone();
      edges.material = new LineBasicMaterial({ color: colours.ghost, transparent: true, opacity: 0.75 });
      ghost = new Group().add(edges);
      world.add(ghost);
    }
    const rest = new Vector3(...now.grip).sub(home(now.part));
    const grip = rest.applyQuaternion(one.quaternion).add(one.position);
    ghost.quaternion.copy(one.quaternion);
    ghost.position.copy(one.position).add(now.base).sub(grip);
    ghost.visible = now.base.distanceTo(grip) > 0.002 * size;
  }
  function hideGhost(): void {
    if (!ghost) return;
    world.remove(ghost);
    ((ghost.children[0] as Line).material as LineBasicMaterial).dispose();
    ghost = null;
  }
  const fromMiddle = (point: Vector3): Triple => point.clone().sub(middle).toArray() as Triple;
  controls.addEventListener("change", () => {
    canvas.dataset.eye = JSON.stringify(fromMiddle(camera.position));
    hand.seen({ at: fromMiddle(camera.position), target: fromMiddle(controls.target) });
  });
  const gone = new AbortController();
  const { signal } = gone;
  // before the controls hear it: they are asleep while a part is in the hand
  canvas.addEventListener("pointerdown", press, { signal, capture: true });
  canvas.addEventListener("pointermove", move, { signal });
  for (const kind of ["pointerup", "pointercancel"] as const) canvas.addEventListener(kind, lift, { signal });
  canvas.addEventListener("pointerleave", () => hand.hover(null), { signal });

  return {
    solids(next) {
      fresh ||= given === null || next.of.length !== given.of.length;
      for (const one of parts) world.remove(one);
      for (const { body, inside, outline } of parts) [body.geometry, outline.geometry, body.material, inside.material, outline.material].forEach((one) => one.dispose());
      given = next;
      const shapes = surfacesOf(next).map(shape3d);
      parts = next.of.map((k) => new Solid3d(shapes[k]!));
      world.add(...parts);
      const { low, high } = boxOf(next);
      size = Math.max(...high.map((v, k) => v - low[k]!)) || 1;
      middle.set(...(low.map((v, k) => (v + high[k]!) / 2) as Triple));
      half.set(...(low.map((v, k) => (high[k]! - v) / 2) as Triple));
      view.ask();
    },
    looks(looks, next) {
      colours = next;
      names = looks.map((one) => one.name);
      looks.forEach(({ fill, edge, see }, p) => {
        const part = parts[p];
        if (!part) return;
        part.paint(fill, edge);
        part.userData.see = see;
        part.body.visible = !see;
      });
      view.ask();
    },
    ask: view.ask,
    fit: view.look,
    keepFitted: () => void (fresh || view.keep()),
    zoom: view.zoom,
    turn: view.turn,
    along,
    see: ({ at, target }) => view.put(new Vector3(...at).add(middle), new Vector3(...target).add(middle)),
    across(part, right, up) {
      const one = parts[part]!;
      const far = camera.position.distanceTo(one.position);
      const perPixel = (2 * far * Math.tan((camera.fov * Math.PI) / 360)) / Math.max(canvas.clientHeight, 1);
      return new Vector3(right * perPixel, up * perPixel, 0).applyQuaternion(camera.quaternion).toArray() as Triple;
    },
    remove() {
      gone.abort();
      axes.remove();
      view.remove();
    },
  };
}

/** Takes everything out of a group. */
function drop(group: Group): void {
  group.traverse((one) => {
    const { geometry, material } = one as unknown as { geometry?: BufferGeometry; material?: { dispose(): void } };
    if (one.parent instanceof ArrowHelper === false) geometry?.dispose(); // arrows share theirs
    material?.dispose();
  });
  group.clear();
}

/** The directions of x, y and z in a corner; one that is pressed is looked along. */
function axesIn(box: HTMLElement, along: (axis: number) => void): { draw(eye: Quaternion, colours: readonly string[]): void; remove(): void } {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("class", "axes");
  svg.setAttribute("viewBox", "-50 -50 100 100");
  svg.setAttribute("aria-hidden", "true");
  const drawn = ["x", "y", "z"].map((name, k) => {
    const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
    const text = document.createElementNS("http://www.w3.org/2000/svg", "text");
    const spot = document.createElementNS("http://www.w3.org/2000/svg", "circle");
    const tip = document.createElementNS("http://www.w3.org/2000/svg", "title");
    text.textContent = name;
    tip.textContent = `look along ${name} (${name.toUpperCase()})`;
    spot.setAttribute("r", "14");
    spot.append(tip);
    spot.addEventListener("click", () => along(k));
    svg.append(line, text, spot);
    return { line, text, spot };
  });
  box.append(svg);
  return {
    draw(eye, colours) {
      const back = eye.clone().invert();
      [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)].forEach((axis, k) => {
        const { x, y } = axis.applyQuaternion(back);
        const { line, text, spot } = drawn[k]!;
        for (const [key, value] of [["x2", x * AXIS], ["y2", -y * AXIS]] as const) line.setAttribute(key, value.toFixed(1));
        text.setAttribute("x", (x * (AXIS + 9)).toFixed(1));
        text.setAttribute("y", (-y * (AXIS + 9)).toFixed(1));
        spot.setAttribute("cx", text.getAttribute("x")!);
        spot.setAttribute("cy", text.getAttribute("y")!);
        line.setAttribute("stroke", colours[k]!);
        text.setAttribute("fill", colours[k]!);
      });
    },
    remove: () => svg.remove(),
  };
}

(globalThis as { openStage?: typeof openStage }).openStage = openStage; // as one file without imports
