/** What can be saved: picture, film, report, numbers, the assembly, files to cut, and the command that says it again. */

import { signal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { dimension, inSpace } from "../design.ts";
import type { SaveWhat } from "../protocol.ts";
import { copy } from "../save.ts";
import { link, save } from "../session.ts";
import { leavingAbout } from "../leaving.ts";
import { answer, can, current, drawing, running } from "../state.ts";
import { Button } from "./Button.tsx";
import { stepInMenu } from "./menuKeys.ts";
import { NumberBox } from "./NumberBox.tsx";

interface Choice { what: SaveWhat; words: string; ending: string; needs?: string; asked?: true; of?: 2 | 3 }
const CHOICES: Choice[] = [
  { what: "svg", words: "Picture", ending: "svg", asked: true },
  { what: "png", words: "Picture", ending: "png", asked: true },
  { what: "gif", words: "Film", ending: "gif", needs: "film", asked: true },
  { what: "mp4", words: "Film", ending: "mp4", needs: "film", asked: true },
  { what: "glb", words: "Model of the moved parts", ending: "glb", asked: true, of: 3 },
  { what: "html", words: "Report", ending: "html", asked: true },
  { what: "json", words: "Answer in numbers", ending: "json", asked: true },
  { what: "stills", words: "A picture of every step", ending: "zip", of: 2 },
  { what: "assembly", words: "Assembly file", ending: "json" },
  { what: "cut-svg", words: "Outlines to cut", ending: "svg", of: 2 },
  { what: "cut-lbrn2", words: "Outlines to cut", ending: "lbrn2", of: 2 },
  { what: "cut-lbrn", words: "Outlines to cut", ending: "lbrn", of: 2 },
  { what: "cut-dxf", words: "Outlines to cut", ending: "dxf", needs: "dxf", of: 2 },
];

/** Width of the cut [mm], where the cutter follows the lines: outlines to cut lie half of it further out. */
const kerf = signal(0);

/** Outlines go into the file that was opened, where that is of their format, and all else in it stays. */
const inFile = (ending: string): boolean => drawing.value?.name.toLowerCase().endsWith(`.${ending}`) ?? false;
const named = ({ what, words, ending }: Choice): string =>
  !what.startsWith("cut-") ? words : inFile(ending) ? `${words}, in your file` : `${words}, alone`;

export function SaveMenu() {
  const [open, setOpen] = useState(false);
  const root = useRef<HTMLDivElement>(null);
  useEffect(() => {
    if (!open) return;
    const outside = (event: PointerEvent): void => {
      if (!root.current?.contains(event.target as Node)) setOpen(false);
    };
    root.current?.querySelector<HTMLElement>("[role=menuitem]:not(:disabled)")?.focus();
    addEventListener("pointerdown", outside);
    return () => removeEventListener("pointerdown", outside);
  }, [open]);
  const film = leavingAbout();
  const pick = (what: SaveWhat): void => {
    setOpen(false);
    save(what, what.startsWith("cut-") ? kerf.peek() : 0);
    root.current?.querySelector("button")?.focus();
  };
  const keys = (event: KeyboardEvent): void => {
    if (!open) return;
    if (!stepInMenu(root.current, event)) return;
    setOpen(false);
    root.current?.querySelector("button")?.focus();
  };
  const command = (film ?? (current(answer.value) ? answer.value : null))?.reply.command;
  return (
    <div class="menu" ref={root} onKeyDown={keys}>
      <Button icon="save" label="Save" keyName="S" onClick={() => setOpen(!open)} disabled={!drawing.value} pressed={open} class="savebutton">
        {running.value.has("save") ? "Saving…" : "Save"}
      </Button>
      {open && (
        <div class="popup">
          <div role="menu" aria-label="Save">
            {CHOICES.filter(({ what, of, ending }) => (what !== "stills" || film?.reply.kind === "plan") && (!what.startsWith("cut-lbrn") || inFile(ending)) && (of ?? dimension.value) === dimension.value).map((one) => {
              const { what, ending, needs, asked } = one;
              const missing = needs !== undefined && !can(needs);
              return (
                <button
                  key={what} type="button" role="menuitem" disabled={missing || (asked && !answer.value && !film)} onClick={() => pick(what)}
                  title={missing ? `needs the extra ${needs}: pip install '.[${needs}]'` : undefined}
                >
                  <span>{named(one)}</span><kbd>{ending}</kbd>
                </button>
              );
            })}
            <button type="button" role="menuitem" onClick={() => (setOpen(false), copy(link(), "copied: the link opens this design in this browser while the server runs"))}>
              <span>Copy a link to this design</span><kbd>link</kbd>
            </button>
            {command && (
              <button type="button" role="menuitem" onClick={() => (setOpen(false), copy(command))}>
                <span>Copy the command</span><kbd>text</kbd>
              </button>
            )}
          </div>
          {!inSpace() && (
            <label class="kerf" title="Where the cutter follows the lines: outlines to cut lie half of it further out. Leave it where the cutter compensates.">
              <span>kerf of the cut</span><NumberBox value={kerf.value} min={0} step={0.01} unit="mm" none="none" label="kerf of the cut" onChange={(value) => (kerf.value = value)} />
            </label>
          )}
        </div>
      )}
    </div>
  );
}
