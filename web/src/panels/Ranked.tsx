/** Whose gap matters, of parts and of joints, where nothing can be set: on a page that carries its ranking. */

import { coloured, current, ranking, standalone } from "../state.ts";
import { number } from "../words.ts";
import { Section } from "./Section.tsx";
import { Table } from "./Table.tsx";

/** What the colours of the parts mean. */
export function Blamebar({ most, per }: { most: number; per: string }) {
  return (
    <div class="blamebar"><span>0</span><i aria-hidden="true" /><span>{number(most, 3)} {per}</span></div>
  );
}

export function Colouring() {
  return <label class="check"><input type="checkbox" checked={coloured.value} onChange={(event) => (coloured.value = event.currentTarget.checked)} /> colour the parts</label>;
}

export function Ranked() {
  const { parts, unique, per, note } = ranking.value!.reply;
  const all = Object.entries(parts).sort(([, a], [, b]) => b.mm_per_mm - a.mm_per_mm); // names that are numbers come in their own order
  const rows = all.map(([name, one]) => (unique ? [name, one.mm_per_mm, one.percent] : [name, one.mm_per_mm, one.tighter, one.percent]));
  return (
    <>
      <Section title="Whose gap matters most">
        <p>How much further the answer goes for each mm of extra gap around one part.</p>
        <div class="asks"><Colouring /></div>
        <Blamebar most={Math.max(...all.map(([, one]) => one.mm_per_mm), 0)} per={per} />
        <Table columns={["part", per, ...(unique ? [] : ["if tighter"]), "%"]} rows={rows} bar={1} first={60} />
        {note && <p class="quiet note">{note}</p>}
      </Section>
      <Joints />
    </>
  );
}

/** Which joint's gap matters. */
export function Joints() {
  const about = ranking.value;
  if (!about?.reply.joints.length) return null;
  const { joints, per } = about.reply;
  return (
    <Section title="Which joint's gap matters most">
      {!standalone.value && !current(about) && <p class="quiet">ranked for an earlier design</p>}
      <Table columns={["joint", per, "%"]} rows={joints.map((one) => [one.parts, one.mm_per_mm, one.percent])} bar={1} />
    </Section>
  );
}
