/** What outlives a reload, in this tab alone: the token, the file that was dropped, the design. */

import type { Design, Opened } from "./protocol.ts";

const read = (key: string): string | null => {
  try {
    return sessionStorage.getItem(`wiggleroom.${key}`);
  } catch {
    return null;
  }
};
const write = (key: string, text: string | null): void => {
  try {
    if (text === null) sessionStorage.removeItem(`wiggleroom.${key}`);
    else sessionStorage.setItem(`wiggleroom.${key}`, text);
  } catch {
    // Full or forbidden: a reload then begins with the file as it is.
  }
};

/** Token of the address, moved out of it at once so that it is not copied with it. */
export function token(): string {
  const address = new URL(location.href);
  const given = address.searchParams.get("token");
  if (given) {
    if (given !== read("token")) for (const key of ["file", "design"]) write(key, null); // another server: what was kept is not its own
    write("token", given);
    address.searchParams.delete("token");
    history.replaceState(null, "", address.href);
  }
  return given ?? read("token") ?? "";
}

export const keepFile = (name: string, data: string): void => write("file", JSON.stringify({ name, data }));
export const forgetFile = (): void => write("file", null);
export function keptFile(): { name: string; data: string } | null {
  const text = read("file");
  return text ? (JSON.parse(text) as { name: string; data: string }) : null;
}

export const mark = (of: Opened): string => `${of.name}|${of.gap}|${of.parts.length}|${of.size.join(",")}`;

export const keepDesign = (of: Opened, design: Design): void => write("design", JSON.stringify({ mark: mark(of), design }));
export function keptDesign(of: Opened): Design | null {
  const kept = JSON.parse(read("design") ?? "null") as { mark: string; design: Design } | null;
  return kept && kept.mark === mark(of) ? kept.design : null;
}
