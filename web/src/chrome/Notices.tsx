/** What went wrong and what should be known, one line each, until it is read. */

import { useEffect } from "preact/hooks";
import { findings, notice } from "../state.ts";
import { Button } from "./Button.tsx";

const MOST = 8;

export function Notices() {
  const lines = findings.value;
  const note = notice.value;
  useEffect(() => {
    if (!note) return;
    const timer = setTimeout(() => (notice.value = ""), 6000);
    return () => clearTimeout(timer);
  }, [note]);
  return (
    <div class="notices">
      {lines.length > 0 && (
        <div class="notice bad" role="alert">
          <ul>
            {lines.slice(0, MOST).map((one) => <li key={one}>{one}</li>)}
            {lines.length > MOST && <li>and {lines.length - MOST} more</li>}
          </ul>
          <Button icon="close" label="Close" onClick={() => (findings.value = [])} />
        </div>
      )}
      {note && <div class="notice" role="status">{note}<Button icon="close" label="Close" onClick={() => (notice.value = "")} /></div>}
    </div>
  );
}
