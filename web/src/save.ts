/** Hands a file to the browser. */

import { fromBase64, type Saved } from "./protocol.ts";

export function download(saved: Saved): void {
  const url = URL.createObjectURL(new Blob([fromBase64(saved.data)], { type: saved.mime }));
  const link = document.createElement("a");
  link.href = url;
  link.download = saved.name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}
