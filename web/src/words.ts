/** Numbers and directions as the terminal writes them. */

import { type Goal, isPull, isSpatialPull, isTurn, isTwist, type Point } from "./protocol.ts";

/** To so many significant digits, without an exponent wherever that stays readable. */
export function number(value: number, digits = 4): string {
  if (value === 0 || !Number.isFinite(value)) return value === 0 ? "0" : String(value);
  const places = digits - 1 - Math.floor(Math.log10(Math.abs(value)));
  if (places > 12) return value.toExponential(digits - 1);
  if (Math.abs(value) >= 1e7) return String(Number(value.toPrecision(digits)).toExponential()).replace("+", "");
  const rounded = value.toFixed(Math.max(places, 0));
  return rounded.includes(".") ? rounded.replace(/0+$/, "").replace(/\.$/, "") : rounded;
}

export function towards(direction: readonly number[]): string {
  const long = Math.hypot(...direction) || 1;
  const unit = direction.map((v) => v / long);
  const along = unit.findIndex((v) => Math.abs(v) > 1 - 1e-12);
  return along >= 0 ? `${unit[along]! > 0 ? "+" : "-"}${"xyz"[along]}` : `(${unit.map((v) => number(v, 3)).join(", ")})`;
}

export const degrees = ([x, y]: Point): number => (Math.atan2(y, x) * 180) / Math.PI;

export function ask(goal: Goal): string {
  if (isTwist(goal)) return `twist of ${goal.part} about ${towards(goal.turn)}`;
  if (isPull(goal) || isSpatialPull(goal)) return `${goal.part} in ${towards(goal.direction)}`;
  if (isTurn(goal)) return `turn of ${goal.part} ${goal.turn}`;
  return `${goal.part} along w = (${(goal.w ?? []).map((v) => number(v, 3)).join(", ")})`;
}

/** What a record says of a name; parts may be called as what every object has. */
export const own = <T>(record: Readonly<Record<string, T>>, name: string): T | undefined => (Object.hasOwn(record, name) ? record[name] : undefined);

/** Of some things the one whose number is nearest to another one. */
export function nearestBy<T>(some: readonly T[], of: (one: T) => number, to: number): T | undefined {
  return some.reduce<T | undefined>((best, one) => (best === undefined || Math.abs(of(one) - to) < Math.abs(of(best) - to) ? one : best), undefined);
}

/** Decimals that show four digits of the largest of some numbers. */
export function places(values: readonly number[]): number {
  const known = values.filter(Number.isFinite);
  const most = known.reduce((best, one) => Math.max(best, Math.abs(one)), 0);
  if (most === 0 || known.every(Number.isInteger)) return 0;
  return Math.min(Math.max(3 - Math.floor(Math.log10(most)), 0), 9);
}

export function short(name: string, most = 24): string {
  const signs = [...name]; // some take two places in a string
  return signs.length <= most ? name : `${signs.slice(0, most / 2 - 1).join("")}…${signs.slice(-most / 2).join("")}`;
}

/** A name in a line of words: what is written from right to left keeps the numbers after it where they belong. */
export const inLine = (name: string, most?: number): string => (/[\p{Script=Hebrew}\p{Script=Arabic}\p{Script=Syriac}\p{Script=Thaana}\p{Script=Nko}]/u.test(name) ? `\u2068${short(name, most)}\u2069` : short(name, most));

/** Names in a row, the rest counted. */
export function few(names: readonly string[], most = 6): string {
  const more = names.length - most;
  return names.slice(0, most).map((name) => inLine(name)).join(", ") + (more > 0 ? ` and ${more} more` : "");
}

/** Round numbers from `low` to `high`, about `count` of them. */
export function ticks(low: number, high: number, count: number): number[] {
  const rough = (high - low) / Math.max(count, 1);
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((lead) => lead * power >= rough * (1 - 1e-9)) ?? 10);
  const from = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.floor(high / step + 1e-9) - from + 1 }, (_, i) => Number(((from + i) * step).toPrecision(9)));
}
