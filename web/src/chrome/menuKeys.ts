/** What keys do in a menu that is open. */

/** Goes from entry to entry by arrow keys, Home and End; true where the key closes the menu. */
export function stepInMenu(root: HTMLElement | null, event: KeyboardEvent): boolean {
  const items = [...(root?.querySelectorAll<HTMLElement>("[role=menuitem]:not(:disabled)") ?? [])];
  const at = items.indexOf(document.activeElement as HTMLElement);
  const to = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: items.length - 1 }[event.key];
  if (event.key !== "Escape" && to === undefined) return false;
  event.preventDefault();
  event.stopPropagation();
  if (to !== undefined) items[(to + items.length) % items.length]?.focus();
  return event.key === "Escape";
}
