/** What can be done with the part under the pointer, by the second button of a mouse or a long press. */

import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { fixedNames, goals, groupOf, inSpace, pinned, pose, pulledNames, togglePinned, togglePull, toggleTwist } from "../design.ts";
import { isTwist } from "../protocol.ts";
import { askModes, askReach, backToRest, fixOrNot } from "../session.ts";
import { fitAll } from "../stage/camera.ts";
import { chooseMany } from "../stage/lasso.ts";
import { names, outlined } from "../state.ts";
import { short } from "../words.ts";
import { glueOrNot, seePast } from "./Selection.tsx";
import { stepInMenu } from "./menuKeys.ts";

/** Where it is open, in the window [px], and for which part; null of the ground. */
export const menuAt = signal<{ x: number; y: number; part: string | null } | null>(null);

interface Entry { words: string; key?: string; does: () => void; not?: boolean }

function entries(part: string | null): Entry[] {
  if (part === null) return [{ words: "Show all", key: "0", does: fitAll }, { words: "Choose all parts", key: "A", does: () => chooseMany(names.peek()) }, { words: "All parts back to rest", key: "Home", does: backToRest, not: pose.value === null }];
  const stands = fixedNames.value.has(part);
  return [
    { words: stands ? "Let it go" : "Fix", key: "F", does: () => fixOrNot(part) },
    { words: pulledNames.value.has(part) ? "Do not pull it" : "Pull", key: "P", does: () => togglePull(part) },
    { words: groupOf(part) ? "Unglue" : "Glue to another part", key: "G", does: () => glueOrNot(part) },
    { words: pinned.value.has(part) ? "Unpin" : "Pin", key: "N", does: () => togglePinned(part), not: stands },
    { words: "Wiggle", key: "W", does: () => askModes(part), not: stands },
    ...(inSpace() ? [
      { words: goals.value.some((goal) => goal.part === part && isTwist(goal)) ? "Do not twist it" : "Twist", key: "T", does: () => toggleTwist(part) },
      { words: outlined.value.has(part) ? "Fill it again" : "See past it", key: "H", does: () => seePast(part) },
    ] : [
      { words: "Where it can be brought", key: "R", does: () => askReach(part), not: stands },
    ]),
  ];
}

export function ContextMenu() {
  const at = menuAt.value;
  const root = useRef<HTMLDivElement>(null);
  useEffect(() => {
    if (!at) return;
    const close = (event: Event): void => {
      if (!root.current?.contains(event.target as Node)) menuAt.value = null;
    };
    const box = root.current!.getBoundingClientRect(); // it stays in the window
    root.current!.style.setProperty("--x", `${Math.max(0, Math.min(at.x, innerWidth - box.width - 4))}px`);
    root.current!.style.setProperty("--y", `${Math.max(0, Math.min(at.y, innerHeight - box.height - 4))}px`);
    root.current!.querySelector<HTMLElement>("[role=menuitem]:not(:disabled)")?.focus();
    addEventListener("pointerdown", close);
    addEventListener("blur", close);
    return () => {
      removeEventListener("pointerdown", close);
      removeEventListener("blur", close);
    };
  }, [at]);
  if (!at) return null;
  const leave = (does?: () => void): void => {
    menuAt.value = null;
    document.querySelector<HTMLElement>(".stage canvas")?.focus();
    does?.();
  };
  return (
    <div class="popup context" ref={root} role="menu" aria-label={at.part ?? "the picture"} onKeyDown={(event) => stepInMenu(root.current, event) && leave()}>
      {at.part && <p class="strong" aria-hidden="true">{short(at.part, 26)}</p>}
      {entries(at.part).map(({ words, key, does, not }) => <button key={words} type="button" role="menuitem" disabled={not} onClick={() => leave(does)}><span>{words}</span><kbd>{key}</kbd></button>)}
    </div>
  );
}
