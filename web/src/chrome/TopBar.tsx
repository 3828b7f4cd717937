/** The slim bar on top: name, open, save, undo, redo, light or dark, help. */

import { useRef } from "preact/hooks";
import { canRedo, canUndo, redo, undo } from "../design.ts";
import { openPicked } from "../session.ts";
import { isDark, setTheme, theme } from "../stage/colours.ts";
import { atStart, standalone, drawing, helpOpen, line, workerState } from "../state.ts";
import { Button } from "./Button.tsx";
import { SaveMenu } from "./SaveMenu.tsx";

const NEXT = { auto: "light", light: "dark", dark: "auto" } as const;

export function TopBar() {
  const box = useRef<HTMLInputElement>(null);
  const take = async (): Promise<void> => {
    const file = box.current?.files?.[0];
    if (file) await openPicked(file);
    if (box.current) box.current.value = "";
  };
  return (
    <header class="topbar">
      {drawing.value && !standalone.value ? (
        <button type="button" class="brand" aria-label="wiggleroom: samples and files opened before" title="Samples and files opened before" aria-expanded={atStart.value} onClick={() => (atStart.value = !atStart.peek())}><Mark /><span class="wordmark">wiggleroom</span></button>
      ) : <span class="brand" role="img" aria-label="wiggleroom"><Mark /><span class="wordmark">wiggleroom</span></span>}
      <h1 class="filename" title={drawing.value?.name}>{drawing.value?.name ?? ""}</h1>
      <Line />
      <span class="spring" />
      {!standalone.value && (
        <>
          <input ref={box} class="unseen" type="file" accept=".svg,.dxf,.lbrn2,.lbrn,.json,.puz,.xmpuzzle" tabIndex={-1} aria-label="drawing" onChange={take} id="file" />
          <Button icon="open" label="Open a drawing" keyName="O" onClick={() => box.current?.click()}>Open</Button>
          <SaveMenu />
          <span class="rule" />
          <Button icon="undo" label="Undo" keyName="Control+Z" onClick={undo} disabled={!canUndo.value} />
          <Button icon="redo" label="Redo" keyName="Control+Shift+Z" onClick={redo} disabled={!canRedo.value} />
          <span class="rule" />
        </>
      )}
      <Button
        icon={theme.value === "auto" ? "auto" : isDark() ? "moon" : "sun"} label={`Colours: ${theme.value === "auto" ? "as the system" : theme.value}`}
        onClick={() => setTheme(NEXT[theme.value])} class="optional"
      />
      <Button icon="help" label="Keys and help" keyName="?" onClick={() => (helpOpen.value = true)} />
    </header>
  );
}

/** Two pieces with room between them. */
function Mark() {
  return (
    <svg class="mark" viewBox="0 0 24 24" aria-hidden="true">
      <path class="stay" d="M2 4h10v5c2.500-1.500 5-.2 5 3s-2.500 4.500-5 3v5h-10z" />
      <path class="move" d="M14 4h8v16h-8v-2.600c3-.2 5-2.200 5-5.400s-2-5.200-5-5.400z" />
    </svg>
  );
}

function Line() {
  if (standalone.value) return null;
  if (line.value === "refused") return <span class="pill bad" role="status">not let in</span>;
  if (line.value === "broken") return <span class="pill bad" role="status">no server: trying again</span>;
  if (workerState.value === "lost") return <span class="pill warn" role="status">solver lost, starting anew</span>;
  return null;
}
