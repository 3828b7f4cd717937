/** What should be known, for a while. */

import { useEffect } from "preact/hooks";
import { notice } from "../state.ts";
import { Button } from "./Button.tsx";

const SHOWN = 8000;

export function Notices() {
  const note = notice.value;
  useEffect(() => {
    if (!note) return;
    const timer = setTimeout(() => (notice.value = ""), SHOWN);
    return () => clearTimeout(timer);
  }, [note]);
  return <div class="notices" role="status">{note && <><span title={note}>{note}</span><Button icon="close" label="Close" onClick={() => (notice.value = "")} class="small" /></>}</div>;
}
