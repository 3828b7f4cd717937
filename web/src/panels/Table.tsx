/** A table that is sorted by a click on the head of a column; of many rows it shows the first ones. */

import { useSignal } from "@preact/signals";
import type { Cell } from "../protocol.ts";
import { chooseMany } from "../stage/lasso.ts";
import { indexOf, many, printing, selected } from "../state.ts";
import { places, short } from "../words.ts";

const MORE = 200;

interface Asked {
  columns: readonly string[]; rows: readonly (readonly Cell[])[];
  /** The column that is drawn as a bar too. */
  bar?: number;
  /** So many rows are shown at first. */
  first?: number;
  onHover?: (row: number | null) => void;
}

/** Number of a cell to sort by; what is not known is the least. */
const value = (cell: Cell): number => (cell === null ? -Infinity : cell === "∞" ? Infinity : Number(cell));
const words = (cell: Cell): string => (cell === null ? "" : String(cell));

export function Table({ columns, rows, bar, first = 12, onHover }: Asked) {
  const sorted = useSignal<{ column: number; down: boolean } | null>(null);
  const most = useSignal(first);
  const numeric = columns.map((_, k) => rows.some((row) => typeof row[k] === "number") && rows.every((row) => typeof row[k] !== "object" || row[k] === null));
  const decimals = columns.map((_, k) => (numeric[k] ? places(rows.map((row) => value(row[k]!))) : 0));
  const order = rows.map((_, i) => i);
  const by = sorted.value;
  if (by) {
    const { column: k } = by;
    const sign = by.down ? -1 : 1;
    order.sort((a, b) => {
      const [x, y] = [rows[a]![k]!, rows[b]![k]!];
      return sign * (numeric[k] ? Math.sign(value(x) - value(y)) || 0 : words(x).localeCompare(words(y), undefined, { numeric: true }));
    });
  }
  const largest = bar === undefined ? 0 : Math.max(...rows.map((row) => Math.abs(value(row[bar]!))), 1e-12);
  const shown = printing.value ? order : order.slice(0, most.value);
  const cell = (one: Cell, k: number) => {
    if (numeric[k]) return one === null ? "–" : one === "∞" ? one : (value(one) + 0).toFixed(decimals[k]);
    const names = typeof one === "string" ? [one] : (one as readonly string[]);
    if (!names.every((name) => indexOf.value.has(name))) return names.join(" | ");
    const words = names.map((name) => short(name, names.length > 1 ? 12 : 18)).join(" | ");
    return <button type="button" class="link" title={names.length > 1 ? `${names.join(" | ")}: choose both` : names[0]} onClick={() => chooseMany(names)}>{words}</button>;
  };
  const isChosen = (first: Cell): boolean => {
    const names = [first].flat() as Cell[];
    return names.includes(selected.value ?? "\n") || (many.value.size > 0 && names.every((name) => many.value.has(name as string)));
  };
  return (
    <>
      <div class="scroll">
        <table class="sorts">
          <thead>
            <tr>
              {columns.map((name, k) => (
                <th key={k} scope="col" class={numeric[k] ? "n" : ""} aria-sort={by?.column === k ? (by.down ? "descending" : "ascending") : "none"}>
                  <button type="button" onClick={() => (sorted.value = { column: k, down: by?.column === k ? !by.down : numeric[k]! })}>{name}</button>
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {shown.map((i) => (
              <tr key={i} aria-selected={isChosen(rows[i]![0]!)} onPointerEnter={() => onHover?.(i)} onPointerLeave={() => onHover?.(null)}>
                {rows[i]!.map((one, k) => (
                  <td key={k} class={numeric[k] ? "n" : ""}>
                    {k === bar && <meter min={0} max={largest} value={Math.abs(value(one))} aria-label={columns[k]} />}
                    {cell(one, k)}
                  </td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      {order.length > shown.length && <button type="button" class="link" onClick={() => (most.value += MORE)}>show more of {order.length}</button>}
    </>
  );
}
