/** All keys, in a dialog. */

import { useEffect, useRef } from "preact/hooks";
import { inSpace } from "../design.ts";
import { standalone, helpOpen } from "../state.ts";
import { pages } from "../panels/Panel.tsx";
import { Button } from "./Button.tsx";

type Row = readonly [keys: string, words: string];
/** What serves without a server too. */
const LOOK: Row[] = [
  [", .", "choose the part before or after"], ["Space", "play or pause the path"], ["+ −", "zoom"], ["0", "fit the drawing"], ["M", "measure between two edges or corners"],
  ["Esc", "back to the answer, let the part go"], ["?", "this list"],
];
const KEYS: Row[] = [
  [", .", "choose the part before or after"], ["F", "fix the chosen part, or let it go"], ["P", "pull the chosen part, or stop pulling it"],
  ["G", "glue the chosen part to another one"], ["L", "choose many: draw a line round them (or Shift and drag on the ground; Shift and press adds one)"], ["A", "choose all parts"], ["N", "pin the chosen part for the moment: it stands while others are dragged"], ["W", "wiggle: show every freedom that is left"],
  ["R", "show where the chosen part can be brought"], ["← ↑ → ↓", "of a pulled part: point the pull that way (Shift: turn it by 5°); else drag the part a step"],
  ["Space", "play or pause the path"], ["+ −", "zoom"], ["0", "fit the drawing"], ["M", "measure between two edges or corners"], ["[ ]", "gap smaller or larger by a step"],
  ["Home", "bring all parts back to rest"], ["Ctrl Z", "undo, also a drag; Ctrl Y redo"], ["O, Ctrl O", "open a drawing"], ["S, Ctrl S", "save"], ["B", "keep this answer beside"], ["Esc", "cancel work, back to the answer, let the part go"],
  ["?", "this list"],
];
const SPACE_KEYS: Row[] = [
  ["← ↑ → ↓", "turn the view"], ["X Y Z", "look along an axis; again from its other side"], ["Shift ← ↑ → ↓", "drag the chosen part a step, in the plane of the picture"], [", .", "choose the part before or after"],
  ["F", "fix the chosen part, or let it go"], ["P", "pull the chosen part, or stop pulling it"], ["T", "twist the chosen part, or stop"], ["G", "glue the chosen part to another one"],
  ["H", "outline the chosen part alone, to see past it"], ["W", "wiggle: show every freedom that is left"], ["Space", "play or pause the path"], ["+ −", "nearer, further"], ["0", "the whole assembly"], ["[ ]", "gap smaller or larger by a step"],
  ["N", "pin the chosen part for the moment: it stands while others are dragged"], ["Home", "bring all parts back to rest"],
  ["Ctrl Z", "undo, also a drag; Ctrl Y redo"], ["O, Ctrl O", "open a file"], ["S, Ctrl S", "save"], ["Esc", "cancel work, back to the answer, let the part go"], ["?", "this list"],
];
const SPACE_MICE: Row[] = [
  ["Drag a part", "it goes as near to the pointer as the others let it, in the plane of the picture"], ["Click a part", "choose it"],
  ["Drag the ground or what is fixed", "turn the view"], ["Right button, two fingers", "move the view"], ["Wheel, pinch", "nearer, further"],
];
const LOOK_MICE: Row[] = [["Click a part", "choose it"], ["Drag, wheel, pinch", "pan and zoom"]];
const MICE: Row[] = [
  ["Drag a part", "it goes as near to the pointer as the others let it, and stays there"], ["Click a part", "choose it"],
  ["Drag the arrow", "its head turns the pull, its foot takes it to another part"], ["Drag the ground, wheel, pinch", "pan and zoom"], ["Space and drag", "pan, also from a part"], ["Right button", "what can be done with a part"],
];

export function Help() {
  const dialog = useRef<HTMLDialogElement>(null);
  const open = helpOpen.value;
  useEffect(() => {
    if (open) dialog.current?.showModal();
    else dialog.current?.close();
  }, [open]);
  const numbers: Row = [`1 … ${pages.value.length}`, "panels"];
  const rows = (all: readonly Row[]) => all.map(([key, words]) => <div key={key}><dt>{key}</dt><dd>{words}</dd></div>);
  return (
    <dialog ref={dialog} class="help" aria-label="Keys and help" onClose={() => (helpOpen.value = false)}>
      <header><h2>Keys</h2><Button icon="close" label="Close" onClick={() => (helpOpen.value = false)} /></header>
      <dl>{rows([...(standalone.value ? LOOK : inSpace() ? SPACE_KEYS : KEYS), numbers])}</dl>
      <h2>Mouse and touch</h2>
      <dl>{rows(standalone.value ? LOOK_MICE : inSpace() ? SPACE_MICE : MICE)}</dl>
      {!standalone.value && <p>What you open stays on this machine: the page speaks only to the program that serves it.</p>}
    </dialog>
  );
}
