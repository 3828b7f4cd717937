/** A box for a number that takes it when it is finished: by Enter, by leaving, or by the arrows. */

import { useEffect, useRef } from "preact/hooks";
import { redo, undo } from "../design.ts";
import { drawing, notice } from "../state.ts";
import { number } from "../words.ts";

interface Asked { value: number; onChange: (value: number) => void; label: string; min?: number; step?: number; unit?: string; digits?: number; disabled?: boolean;
  /** What the empty box says, which stands for 0. */
  none?: string;
}

/** What the keys of undo and redo mean, in a box as elsewhere on the page. */
export function stepOfHistory(event: KeyboardEvent): (() => void) | null {
  if (!event.ctrlKey && !event.metaKey) return null;
  const key = event.key.toLowerCase();
  if (key === "y" || (key === "z" && event.shiftKey)) return redo;
  return key === "z" ? undo : null;
}

export function NumberBox({ value, onChange, label, min, step, unit, digits = 5, disabled, none }: Asked) {
  const box = useRef<HTMLInputElement>(null);
  const text = none && value === 0 ? "" : number(value, digits);
  const now = useRef(text);
  now.current = text;
  const typing = useRef(false);
  const tell = (): void => {
    typing.current = false;
    if (box.current) box.current.value = now.current;
  };
  const tellSoon = (): void => { // unless somebody types again before
    typing.current = false;
    setTimeout(() => typing.current || tell());
  };
  // whatever is being typed: a number that has changed by other hands is seen, and what was typed for another file is left out
  useEffect(tell, [text, label, drawing.value]);
  const take = (): void => {
    if (!box.current) return; // it has gone with what it was about
    const given = box.current.value.trim();
    if (given === text) return; // the value itself may have more digits
    const typed = Number(given.replace(",", "."));
    if (!Number.isFinite(typed) || (given === "" && !none) || (min !== undefined && typed < min)) {
      notice.value = `${label}: “${given}” is not ${min === undefined ? "a number" : `a number of ${min} or more`}; it stays ${text || none}${text && unit ? ` ${unit}` : ""}`;
      box.current.value = text;
    } else if (typed !== value) onChange(typed);
    tellSoon(); // what is taken may be another number than what was typed
  };
  const keys = (event: KeyboardEvent): void => {
    event.stopPropagation();
    const wanted = stepOfHistory(event);
    if (wanted) {
      event.preventDefault();
      const typed = typing.current;
      tell();
      if (!typed) wanted();
      return;
    }
    if (event.key === "Enter") take();
    if (event.key === "Escape") {
      box.current!.value = text;
      box.current!.blur();
    }
    if (step && (event.key === "ArrowUp" || event.key === "ArrowDown")) {
      event.preventDefault();
      const next = Math.max(min ?? -Infinity, value + (event.key === "ArrowUp" ? step : -step) * (event.shiftKey ? 10 : 1));
      box.current!.value = number(next, digits);
      onChange(Number(next.toPrecision(9)));
    }
  };
  return (
    <span class="numberbox" style={{ "--letters": (text || none || "").length }}>
      <input ref={box} type="text" inputMode="decimal" aria-label={unit ? `${label}, ${unit}` : label} disabled={disabled} placeholder={none} onInput={() => (typing.current = true)} onChange={take} onBlur={tellSoon} onKeyDown={keys} />
      {unit && <span class="unit" aria-hidden="true">{unit}</span>}
    </span>
  );
}
