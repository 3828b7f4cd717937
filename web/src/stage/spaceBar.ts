/** The space bar: held, the picture is moved by the pointer; pressed alone, the motion plays. */

import { signal } from "@preact/signals";

export const spaceHeld = signal(false);
let used = false;

export function holdSpace(): void {
  if (!spaceHeld.peek()) used = false;
  spaceHeld.value = true;
}

/** The pointer has moved the picture meanwhile. */
export const useSpace = (): void => void (used = true);

/** Lets it go; true where nothing was done meanwhile. */
export function releaseSpace(): boolean {
  const alone = spaceHeld.peek() && !used;
  spaceHeld.value = false;
  return alone;
}
