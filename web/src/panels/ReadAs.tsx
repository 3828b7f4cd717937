/** How the file was read: what was assumed or left out, and what can be said about it; then it is read again at once. */

import { signal } from "@preact/signals";
import { asRead, readAgain } from "../session.ts";
import type { HowRead } from "../protocol.ts";
import { drawing, standalone } from "../state.ts";
import { Button } from "../chrome/Button.tsx";
import { number } from "../words.ts";
import { NumberBox } from "../chrome/NumberBox.tsx";
import { Section } from "./Section.tsx";

const UNITS: Record<string, string> = { "": "as the file says", mm: "mm", cm: "cm", m: "m", in: "inch", px: "px (96 an inch)", "90dpi": "px of old programs (90 an inch)", pt: "point (72 an inch)" };
const LISTS = [
  ["only", "read only", "layers, colours or names; all others are left out", "all"],
  ["skip", "leave out", "layers, colours or names", "none"],
  ["solid", "parts, not holes", "names of outlines inside others, @x,y for a point in one, or all", "none"],
  ["hole", "holes", "names of outlines that are cut out of the part around or under them, @x,y for a point in one, or all", "none"],
] as const;

const unfolded = signal(false);

const listed = (text: string): string[] => text.split(",").map((one) => one.trim()).filter(Boolean);
/** Names in a box: what has a comma of its own, as a point has, keeps together. */
const points = (text: string): string[] => listed(text.replace(/@\s*([-\d.]+)\s*,\s*([-\d.]+)/g, "@$1;$2")).map((one) => (one.startsWith("@") ? one.replace(";", ",") : one));

export function ReadAs() {
  const opened = drawing.value!;
  const before = opened.reading;
  if (standalone.value) return null;
  const { notes } = opened;
  const put = (next: Partial<HowRead>): void => {
    const wanted = { ...before!, ...next };
    if (JSON.stringify(wanted) !== JSON.stringify(before)) readAgain(wanted);
  };
  return (
    <Section title="How the file was read" side={<Button label="Set everything as the file says; undo leads back" onClick={asRead} class="small">As the file says</Button>}>
      <p class="quiet">The drawing is {number(opened.size[2] - opened.size[0])} × {number(opened.size[3] - opened.size[1])} mm.</p>
      {notes.length > 0 ? <ul class="rows readnotes" aria-label="notes on how the file was read">{notes.map((note) => <li key={note}>{note}</li>)}</ul> : <p class="quiet">Nothing was assumed or left out.</p>}
      {before && (
        <details class="note" open={unfolded.value} onToggle={(event) => (unfolded.value = event.currentTarget.open)}>
          <summary>Read it in another way</summary>
          <div class="reading">
            <label>unit of its numbers
              <select value={before.unit ?? ""} onChange={(event) => put({ unit: (event.currentTarget.value || null) as HowRead["unit"] })}>
                {Object.entries(UNITS).map(([unit, words]) => <option key={unit} value={unit}>{words}</option>)}
              </select>
            </label>
            {LISTS.map(([key, words, hint, none]) => (
              <label key={key} title={hint}>{words}
                <input class="search" type="text" placeholder={none} value={(before[key] ?? []).join(", ")} onChange={(event) => put({ [key]: points(event.currentTarget.value) })} />
              </label>
            ))}
            <label title="open ends nearer than this are joined">join ends <NumberBox value={before.join ?? 0} min={0} step={0.05} unit="mm" none="auto" label="open ends nearer than this are joined" onChange={(value) => put({ join: value || null })} /></label>
          </div>
        </details>
      )}
    </Section>
  );
}
