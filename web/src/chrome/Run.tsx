/** The button that asks for something long; while it is under way, the one that ends it. */

import type { Kind } from "../protocol.ts";
import { cancel } from "../session.ts";
import { running } from "../state.ts";
import { Button } from "./Button.tsx";

interface Asked { kind: Kind; label: string; onClick: () => void; disabled?: boolean; children: string }

export function Run({ kind, label, onClick, disabled, children }: Asked) {
  if (running.value.has(kind)) return <Button label="Cancel" onClick={() => cancel(kind)}>Cancel</Button>;
  return <Button label={label} onClick={onClick} disabled={disabled} class="main">{children}</Button>;
}
