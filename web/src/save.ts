/** Hands files and text to the browser. */

import { fromBase64, type Saved } from "./protocol.ts";
import { notice } from "./state.ts";

export async function copy(text: string, said = "copied"): Promise<void> {
  const done = await navigator.clipboard?.writeText(text).then(() => true, () => false);
  notice.value = done ? said : "the browser does not let this page copy: select the text";
}

export function download(saved: Saved): void {
  const url = URL.createObjectURL(new Blob([fromBase64(saved.data)], { type: saved.mime }));
  const link = document.createElement("a");
  link.href = url;
  link.download = saved.name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}
