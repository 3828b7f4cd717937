/** The button that asks for something long; while it is under way, the one that ends it. Nothing is asked while a file is
 * opened: that would be about the one before. */

import { cancel } from "../session.ts";
import { opening, running } from "../state.ts";
import { Button } from "./Button.tsx";

interface Asked { kind: string; label: string; onClick: () => void; disabled?: boolean; children: string }

export function Run({ kind, label, onClick, disabled, children }: Asked) {
  if (running.value.has(kind)) return <Button label="Cancel" onClick={() => cancel(kind)}>Cancel</Button>;
  return <Button label={label} onClick={onClick} disabled={disabled || opening.value !== ""} class="main">{children}</Button>;
}
