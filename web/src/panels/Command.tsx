/** The command that says the same. */

import { Button } from "../chrome/Button.tsx";
import { copy } from "../save.ts";
import { Section } from "./Section.tsx";

export function Command({ text }: { text?: string }) {
  if (!text) return null;
  return (
    <Section title="The same in a terminal" side={<Button icon="copy" label="Copy the command" onClick={() => copy(text)} />}>
      <pre class="command" tabIndex={0}>{text}</pre>
    </Section>
  );
}
