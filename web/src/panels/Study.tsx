/** What a study says beside the answer: pictures, tables and terms, as they came. */

import { standalone } from "../state.ts";
import type { StudyTab } from "../protocol.ts";
import { Blamebar } from "./Ranked.tsx";
import { Section } from "./Section.tsx";
import { Table } from "./Table.tsx";
import { Terms } from "./Terms.tsx";

export function Study() {
  const { study, tints } = standalone.value!;
  return (
    <>
      {tints?.per && <Blamebar most={Math.max(...Object.values(tints.values))} per={tints.per} />}
      <Sections of={study!} />
    </>
  );
}

export function Sections({ of }: { of: StudyTab }) {
  return (
    <>
      {of.sections.map(({ title, text, svg, columns, rows, terms }) => (
        <Section key={title} title={title}>
          {text && <p>{text}</p>}
          {svg && <figure class="plot" dangerouslySetInnerHTML={{ __html: svg }} />}
          {rows.length > 0 && <Table columns={columns} rows={rows} />}
          {terms.length > 0 && <Terms all={terms} />}
        </Section>
      ))}
    </>
  );
}
