/** What a word of the answer means, in a sentence, where it stands. */

import { useEffect, useId, useRef, useState } from "preact/hooks";

const VERDICTS: Record<string, string> = {
  proven: "Proven: a bound shows that no motion is worth more than 0.1 % more.",
  optimal: "Optimal: every surface that stops it is really touched, and no small change goes further. A quite different path might.",
  stationary: "Stationary, that is at a standstill: no small change goes further from here, but at some contacts it could also pass on another side, which was not tried. The motion itself is checked; it may not be the largest.",
  "found so far": "Found so far: no small change goes further from here. A search from other starts has not ended, and may find a much larger motion.",
  "found from rest": "Found from rest: no small change goes further from here. So many parts move that no search from other starts follows: a much larger motion may remain unfound.",
  unbounded: "Unbounded: nothing stops it. The parts that leave were followed all the way out.",
  stopped: "Stopped: time ran out. The motion shown is safe, and further ones may exist.",
  touching: "Touching: parts touch at rest, so there is no room to begin in. A larger gap gives it.",
  "cannot be made": "Cannot be made: the outlines of some part cannot be moved inward by so much. A smaller gap helps.",
};

export const FORCE = "How hard this contact presses, as a share of the pull. It is also how much further the answer goes, in mm, for each mm that this contact gives way.";

export function Meaning({ of }: { of: string }) {
  return VERDICTS[of] ? <Explain word={of} words={VERDICTS[of]} /> : null;
}

/** A small question mark that opens one sentence. */
export function Explain({ word, words }: { word: string; words: string }) {
  const [open, setOpen] = useState(false);
  const id = useId();
  const root = useRef<HTMLSpanElement>(null);
  useEffect(() => {
    if (!open) return;
    const outside = (event: Event): void => {
      if (!root.current?.contains(event.target as Node)) setOpen(false);
    };
    addEventListener("pointerdown", outside);
    return () => removeEventListener("pointerdown", outside);
  }, [open]);
  const keys = (event: KeyboardEvent): void => {
    if (event.key !== "Escape" || !open) return;
    event.stopPropagation();
    setOpen(false);
  };
  return (
    <span class="explain" ref={root} onKeyDown={keys}>
      <button type="button" aria-expanded={open} aria-controls={id} aria-label={`what does ${word} mean?`} onClick={() => setOpen(!open)}>?</button>
      <span id={id} class="meaning" role="note" hidden={!open}>{words}</span>
    </span>
  );
}
