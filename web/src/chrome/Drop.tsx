/** Dropping a file, and what is seen before there is one. */

import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { openPicked } from "../session.ts";
import { Start } from "./Start.tsx";
import { atStart, standalone, drawing, line, opening } from "../state.ts";

export function Drop() {
  const over = useSignal(false);
  useEffect(() => {
    if (standalone.value) return;
    const gone = new AbortController();
    const files = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
    const enter = (event: DragEvent): void => {
      if (!files(event)) return;
      event.preventDefault();
      over.value = true;
    };
    const leave = (event: DragEvent): void => {
      if (event.relatedTarget === null) over.value = false;
    };
    const drop = (event: DragEvent): void => {
      event.preventDefault();
      over.value = false;
      const file = event.dataTransfer?.files[0];
      if (file) void openPicked(file);
    };
    addEventListener("dragover", enter, { signal: gone.signal });
    addEventListener("dragleave", leave, { signal: gone.signal });
    addEventListener("drop", drop, { signal: gone.signal });
    return () => gone.abort();
  }, []);
  if (over.value) return <div class="drop over">Let go to open it</div>;
  if (opening.value) return <div class="drop" role="status">Opening {opening.value}…</div>;
  if ((drawing.value && !atStart.value) || standalone.value) return null;
  if (line.value === "refused") {
    return (
      <section class="drop" aria-label="start">
        <div class="calm">
          <p class="big">This address lacks its key</p>
          <p>Open the whole address that <code>wiggleroom serve</code> prints in the terminal: it ends with <code>?token=…</code>, and lets in nobody else.</p>
        </div>
      </section>
    );
  }
  return <Start />;
}
