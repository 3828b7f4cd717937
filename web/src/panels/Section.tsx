/** A piece of a panel under its heading; one of the first steps has a number, and a tick when it is done. */

import type { ComponentChildren } from "preact";

interface Asked { title: string; children: ComponentChildren; side?: ComponentChildren; step?: number; done?: boolean }

export function Section({ title, children, side, step, done }: Asked) {
  return (
    <section class="section">
      <header>
        <h2>{step && <i class={done ? "step done" : "step"} aria-label={done ? `step ${step}, done` : `step ${step}`} role="img">{done ? "✓" : step}</i>}{title}</h2>{side}
      </header>
      {children}
    </section>
  );
}
