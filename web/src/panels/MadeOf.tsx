/** Blocks with joints that are made here: the pattern, the family of the joint and its sizes; drawn anew with each change. */

import { make } from "../session.ts";
import type { JointSize, Made } from "../protocol.ts";
import { drawing, hello, standalone, unopened } from "../state.ts";
import { NumberBox } from "../chrome/NumberBox.tsx";
import { number } from "../words.ts";
import { Section } from "./Section.tsx";

const PATTERNS = ["chain", "frame", "grid", "jigsaw"] as const;
/** Sizes go up to this share of the side of a block. */
const MOST = 0.5;
const MOST_BLOCKS = 64;

export function MadeOf() {
  const made = drawing.value?.made;
  void unopened.value; // sizes that do not fit each other are taken back
  if (!made || standalone.value) return null;
  const put = (next: Partial<Made>): void => make({ ...made, ...next });
  const sizes = (made.pattern === "jigsaw" ? undefined : hello.value?.joints?.[made.joint]) ?? [];
  const count = (key: "nx" | "ny", label: string) => (
    <label>{label} <NumberBox value={made[key]} min={1} step={1} label={label} onChange={(to) => put({ [key]: Math.min(Math.round(to), MOST_BLOCKS) })} /></label>
  );
  return (
    <Section title="Made of joints">
      <div class="asks">
        <label>pattern <select aria-label="pattern of the blocks" value={made.pattern} onChange={(event) => put({ pattern: event.currentTarget.value as Made["pattern"], ny: Math.max(made.ny, 2) })}>
          {PATTERNS.map((name) => <option key={name} value={name}>{name}</option>)}
        </select></label>
        {count("nx", "blocks in a row")}
        {made.pattern !== "chain" && count("ny", "rows")}
        <label>side of a block <NumberBox value={made.pitch} min={0.001} step={1} unit="mm" label="side of a block" onChange={(pitch) => put({ pitch })} /></label>
        {made.pattern !== "jigsaw" && (
          <label>joint <select aria-label="family of the joint" value={made.joint} onChange={(event) => put({ joint: event.currentTarget.value, sizes: {} })}>
            {Object.keys(hello.value?.joints ?? {}).map((name) => <option key={name} value={name}>{name}</option>)}
          </select></label>
        )}
      </div>
      <div class="sizes">
        {sizes.map((size) => <Size key={size.name} size={size} made={made} onChange={(to) => put({ sizes: { ...made.sizes, [size.name]: to } })} />)}
      </div>
    </Section>
  );
}

/** One size: a slider with its box, in mm; of what is counted a box alone. */
function Size({ size: { name, default: usual, whole }, made: { sizes, pitch }, onChange }: { size: JointSize; made: Made; onChange: (to: number) => void }) {
  const words = name.replaceAll("_", " ");
  const value = sizes[name] ?? usual;
  if (whole) return <label><span>{words}</span><NumberBox value={value} min={1} step={1} label={words} onChange={(to) => onChange(Math.round(to))} /></label>;
  return (
    <label><span>{words}</span>
      <input type="range" min={0} max={MOST} step={0.005} value={value} aria-label={words} aria-valuetext={`${number(value * pitch)} mm`} onInput={(event) => onChange(Number(event.currentTarget.value))} />
      <NumberBox value={Number((value * pitch).toPrecision(6))} step={0.01 * pitch} unit="mm" label={words} onChange={(to) => onChange(to / pitch)} />
    </label>
  );
}
