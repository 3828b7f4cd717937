/** A cutting sheet with its joints, to be pressed, beside what it makes in space. */

import { effect, signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { Assembled, Point, SheetEdge, SheetPanel } from "../protocol.ts";
import * as sheet from "../sheet.ts";
import type { SolidView } from "../stage3d.ts";
import { solidView } from "./camera.ts";
import { colours, isDark } from "./colours.ts";
import { AXES, opener } from "./SolidStage.tsx";

const failed = signal("");

export function SheetStage() {
  const found = sheet.assembled.value!;
  return (
    <>
      <Flat found={found} />
      <Space found={found} />
    </>
  );
}

const path = (rings: Point[][]): string => rings.map((ring) => `M${ring.map(([x, y]) => `${x} ${-y}`).join("L")}Z`).join("");

function Flat({ found }: { found: Assembled }) {
  const picture = useRef<SVGSVGElement>(null);
  const all = found.panels.flatMap(({ rings }) => rings[0]!);
  const [xs, ys] = [all.map(([x]) => x), all.map(([, y]) => -y)];
  const margin = 0.03 * Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys));
  const [x0, y0] = [Math.min(...xs) - margin, Math.min(...ys) - margin];
  const [width, height] = [Math.max(...xs) + margin - x0, Math.max(...ys) + margin - y0];
  const colour = new Map(found.joints.map(({ name }, k) => [name, `hsl(${sheet.hueOf(k)} 70% ${isDark() ? 62 : 38}%)`]));
  const place = new Map(found.placed.map((name, k) => [name, k]));
  const size = Math.max(width, height) / 50;
  /** A place of the sheet under the pointer [mm]; without one, the middle of the panel. */
  const under = (event: MouseEvent | KeyboardEvent, panel: SheetPanel): Point => {
    const matrix = picture.current?.getScreenCTM()?.inverse();
    if (!("clientX" in event) || !matrix || event.detail === 0) return panel.centre;
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
    return snapped(panel, [at.x, -at.y], SNAP / Math.abs(picture.current!.getScreenCTM()!.a));
  };
  const panelPressed = (event: MouseEvent | KeyboardEvent, panel: SheetPanel): void => {
    sheet.chosen.value = panel.name;
    const at = under(event, panel);
    sheet.press({ panel: panel.name, edge: `${panel.name}@${at[0]},${at[1]}`, at });
  };
  const edgePressed = (event: MouseEvent | KeyboardEvent, panel: SheetPanel, edge: SheetEdge): void => {
    const at = "clientX" in event && event.detail > 0 ? under(event, panel) : (edge.ends[0].map((v, k) => (v + edge.ends[1][k]!) / 2) as Point);
    sheet.press({ panel: panel.name, edge: edge.reference, at });
  };
  const picked = sheet.picked.value;
  return (
    <div class="sheet" data-broad={width > 1.7 * height}>
      <svg ref={picture} viewBox={`${x0} ${y0} ${width} ${height}`} role="group" aria-label="cutting sheet">
        {found.panels.map((panel) => {
          const lit = sheet.chosen.value === panel.name || picked.some((one) => one.panel === panel.name);
          const k = place.get(panel.name);
          return (
            <path
              key={panel.name} d={path(panel.rings)} fill-rule="evenodd" class={`panelshape ${panel.state}`} data-lit={lit}
              style={k === undefined ? undefined : `fill: hsl(${sheet.hueOf(k)} 45% ${isDark() ? 26 : 88}%)`}
              {...pressable(`panel ${panel.name}, ${STATES[panel.state]}`, lit, (event) => panelPressed(event, panel))}
            />
          );
        })}
        {found.panels.flatMap((panel) => panel.edges.map((edge) => {
          const lit = picked.some((one) => one.edge === edge.reference);
          const [a, b] = edge.ends;
          const words = edge.joints.length ? `joint ${edge.joints.join(", ")}` : "open";
          return (
            <g key={edge.reference} class="edge" data-lit={lit} data-open={edge.joints.length === 0} {...pressable(`edge of ${panel.name} at ${edge.reference.split("@").at(-1)}, ${words}`, lit, (event) => edgePressed(event, panel, edge))}>
              <line class="reach" x1={a[0]} y1={-a[1]} x2={b[0]} y2={-b[1]} />
              <line class="shown" x1={a[0]} y1={-a[1]} x2={b[0]} y2={-b[1]} style={edge.joints[0] ? `stroke: ${colour.get(edge.joints[0])}` : undefined} />
            </g>
          );
        }))}
        <g class="names" aria-hidden="true">
          {found.panels.map(({ name, centre: [x, y] }) => <text key={name} x={x} y={-y} font-size={size}>{name}</text>)}
          {found.joints.flatMap(({ name, on_sheet }) => on_sheet.map(([x, y], side) => <text key={`${name}${side}`} class="joint" x={x} y={-y} font-size={0.8 * size} style={`fill: ${colour.get(name)}`}>{name}</text>))}
        </g>
        <g class="unmatched" aria-hidden="true">
          {found.unmatched.flatMap(({ panel, on_sheet }) => on_sheet.map(([x, y], k) => <path key={`${panel}${k}`} d={`M${x - size / 3} ${-y - size / 3}l${size / 1.5} ${size / 1.5}m0 ${-size / 1.5}l${-size / 1.5} ${size / 1.5}`} />))}
        </g>
      </svg>
    </div>
  );
}

/** So near to an outline a press means it [px]. */
const SNAP = 9;

/** A point of a panel, moved onto the outline where that is near. */
export function snapped(panel: SheetPanel, [x, y]: Point, reach: number): Point {
  let best: Point = [x, y];
  let least = reach;
  for (const ring of panel.rings) {
    ring.forEach(([x0, y0], k) => {
      const [x1, y1] = ring[(k + 1) % ring.length]!;
      const [dx, dy] = [x1 - x0, y1 - y0];
      const t = Math.min(1, Math.max(0, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy || 1)));
      const at: Point = [x0 + t * dx, y0 + t * dy];
      const far = Math.hypot(x - at[0], y - at[1]);
      if (far < least) [least, best] = [far, at];
    });
  }
  return [round(best[0]), round(best[1])];
}

const STATES = { placed: "placed", waiting: "not placed", loose: "loose" } as const;
const round = (value: number): number => Math.round(value * 100) / 100;

/** What makes a piece of the picture a button, by pointer and by keys. */
function pressable(label: string, pressed: boolean, act: (event: MouseEvent | KeyboardEvent) => void) {
  return {
    role: "button" as const, tabindex: 0, "aria-label": label, "aria-pressed": pressed,
    onClick: (event: MouseEvent) => act(event),
    onKeyDown: (event: KeyboardEvent) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      event.stopPropagation();
      act(event);
    },
  };
}

/** The panels as they stand; pressing one chooses it. */
function Space({ found }: { found: Assembled }) {
  const box = useRef<HTMLDivElement>(null);
  const view = useRef<SolidView | null>(null);
  useEffect(() => {
    let gone = false;
    let stop = (): void => {};
    failed.value = "";
    opener().then((open) => {
      if (gone || !box.current) return;
      const rest = (): Float32Array => {
        const motion = new Float32Array(7 * (sheet.assembled.peek()?.placed.length ?? 0));
        for (let i = 6; i < motion.length; i += 7) motion[i] = 1;
        return motion;
      };
      const shown = open(box.current, "", {
        pose: () => ({ motion: rest(), moving: false }),
        end: () => null, film: () => [], factor: () => 1, exploded: () => 0, section: () => null, marks: () => null, free: () => false, seen: () => undefined,
        hover: () => {}, joint: () => {}, menu: () => {}, drag: () => {}, release: () => {},
        choose: (part) => (sheet.chosen.value = part === null ? null : sheet.assembled.peek()!.placed[part]!),
      });
      view.current = solidView.value = shown;
      const canvas = box.current.querySelector("canvas")!;
      canvas.setAttribute("aria-roledescription", "assembly in space");
      const stops = [
        effect(() => {
          const now = sheet.assembled.value;
          if (!now?.placed.length) return;
          shown.solids(now.solids);
          canvas.setAttribute("aria-label", `${now.placed.length} panels put together. Arrow keys turn the view.`);
        }),
        effect(() => {
          const { force, motion, pulled, ink } = colours();
          const looks = (sheet.assembled.value?.placed ?? []).map((name, k) => ({
            name, fill: `hsl(${sheet.hueOf(k)}, 45%, ${isDark() ? 45 : 76}%)`, edge: sheet.chosen.value === name ? force : ink, see: false,
          }));
          shown.looks(looks, { force, motion, ghost: pulled[1], axes: AXES[isDark() ? "dark" : "light"] });
          shown.ask();
        }),
      ];
      stop = () => stops.forEach((each) => each());
    }).catch(() => (failed.value = "This browser shows no 3D pictures (WebGL)."));
    return () => {
      gone = true;
      stop();
      if (solidView.peek() === view.current) solidView.value = null;
      view.current?.remove();
    };
  }, []);
  return (
    <div class="stage solid" ref={box}>
      {found.placed.length === 0 && <p class="drop">No panel could be placed.</p>}
      {failed.value && <p class="drop" role="alert">{failed.value}</p>}
    </div>
  );
}
