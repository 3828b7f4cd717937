/** A piece of a panel under its heading. */

import type { ComponentChildren } from "preact";

export function Section({ title, children, side }: { title: string; children: ComponentChildren; side?: ComponentChildren }) {
  return (
    <section class="section">
      <header><h2>{title}</h2>{side}</header>
      {children}
    </section>
  );
}
