/** Colours of the canvas, those of the pictures; in the dark the same hues on a dark ground. */

import { signal } from "@preact/signals";
import { printing } from "../state.ts";

export interface Colours {
  paper: string; ink: string; quiet: string; rest: string; grid: string;
  neutral: [string, string]; pulled: [string, string]; fixed: [string, string]; leaves: [string, string]; lit: [string, string];
  force: string; motion: string; chosen: string; blame: string[];
}

const LIGHT: Colours = {
  paper: "#ffffff", ink: "#1f2933", quiet: "#66727f", rest: "#aeb6bf", grid: "#eef1f4",
  neutral: ["#e4e9ef", "#7c8894"], pulled: ["#8fc1ea", "#1f5f99"], fixed: ["#e58a80", "#a02c22"],
  leaves: ["#cdbbe8", "#6b4fa0"], lit: ["#fbd9a8", "#c96a00"],
  force: "#c96a00", motion: "#0b3c6f", chosen: "#1f5f99",
  blame: ["#f3f1ec", "#fbe3b8", "#f8bd76", "#ee8a5b", "#d9606a", "#b0508c"],
};

const DARK: Colours = {
  paper: "#12161b", ink: "#e8edf2", quiet: "#98a4b0", rest: "#55606c", grid: "#1b2128",
  neutral: ["#333d48", "#8896a4"], pulled: ["#235a8c", "#8fc1ea"], fixed: ["#7e322a", "#f0a095"],
  leaves: ["#53407c", "#c6b2ea"], lit: ["#6b4415", "#ffb04d"],
  force: "#ffb04d", motion: "#a8d1f5", chosen: "#8fc1ea",
  blame: ["#2b3138", "#4d4230", "#8a6230", "#c0703e", "#e06f78", "#f095c8"],
};

export type Theme = "auto" | "light" | "dark";
const wide = typeof matchMedia === "function" ? matchMedia("(prefers-color-scheme: dark)") : null;
const system = signal(wide?.matches ?? false);
wide?.addEventListener("change", (event) => (system.value = event.matches));

const stored = (): Theme => {
  try {
    return (localStorage.getItem("wiggleroom.theme") as Theme | null) ?? "auto";
  } catch {
    return "auto";
  }
};
export const theme = signal<Theme>(stored());
export const isDark = (): boolean => !printing.value && (theme.value === "auto" ? system.value : theme.value === "dark");
export const colours = (): Colours => (isDark() ? DARK : LIGHT);

export function setTheme(next: Theme): void {
  theme.value = next;
  try {
    localStorage.setItem("wiggleroom.theme", next);
  } catch {
    // Kept for this page alone then.
  }
}

/** Colour of an importance 0..1, between the steps of the row. */
export function blameColour(row: readonly string[], share: number): string {
  const x = Math.min(Math.max(share, 0), 1) * (row.length - 1);
  const k = Math.min(Math.floor(x), row.length - 2);
  const [a, b] = [channels(row[k]!), channels(row[k + 1]!)];
  const mixed = a.map((v, i) => Math.round(v + (x - k) * (b[i]! - v)));
  return `rgb(${mixed.join(",")})`;
}

const channels = (hex: string): number[] => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
