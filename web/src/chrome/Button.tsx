/** A button with an icon, its words for those who do not see it, and its key in the tip. */

import type { ComponentChildren } from "preact";
import { Icon, type IconName } from "./icons.tsx";

interface Asked {
  icon?: IconName; label: string; keyName?: string; onClick: () => void; disabled?: boolean; pressed?: boolean; children?: ComponentChildren;
  class?: string;
}

export function Button({ icon, label, keyName, onClick, disabled, pressed, children, class: extra }: Asked) {
  return (
    <button
      type="button" class={`button ${children ? "worded" : ""} ${extra ?? ""}`} onClick={onClick} disabled={disabled}
      aria-label={children ? undefined : label} aria-pressed={pressed} title={keyName ? `${label} (${keyName})` : label}
      aria-keyshortcuts={keyName}
    >
      {icon && <Icon name={icon} />}
      {children && <span>{children}</span>}
    </button>
  );
}
