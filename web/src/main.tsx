/** The page. */

import { effect } from "@preact/signals";
import { render } from "preact";
import { unpack } from "./standalone.ts";
import { ContextMenu } from "./chrome/ContextMenu.tsx";
import { Drop } from "./chrome/Drop.tsx";
import { GapStrip } from "./chrome/GapStrip.tsx";
import { Headline, Spoken } from "./chrome/Headline.tsx";
import { Help } from "./chrome/Help.tsx";
import { Player } from "./chrome/Player.tsx";
import { Selection } from "./chrome/Selection.tsx";
import { TopBar } from "./chrome/TopBar.tsx";
import { listen } from "./keys.ts";
import { Panel } from "./panels/Panel.tsx";
import { inSpace } from "./design.ts";
import { start } from "./session.ts";
import { assembled } from "./sheetState.ts";
import { isDark } from "./stage/colours.ts";
import { Beside } from "./stage/Beside.tsx";
import { SheetStage } from "./stage/SheetStage.tsx";
import { SolidStage } from "./stage/SolidStage.tsx";
import { Stage } from "./stage/Stage.tsx";
import { atStart, standalone, drawing, tab } from "./state.ts";

/** Whether a cutting sheet is shown with what it makes. */
const onSheet = (): boolean => tab.value === "sheet" && assembled.value !== null && !inSpace();

function Page() {
  return (
    <div class="page" data-empty={drawing.value === null} data-wide={tab.value === "study" || (standalone.value !== null && tab.value === "space")}>
      <TopBar />
      <main class="middle" inert={atStart.value || (drawing.value === null && !standalone.value)}>
        <Headline />
        <div class="stages">
          {onSheet() ? <SheetStage /> : <><Beside />{inSpace() ? <SolidStage /> : <Stage />}</>}
        </div>
        {!onSheet() && <><Selection /><Player /></>}
        <ContextMenu />
      </main>
      {!onSheet() && <GapStrip />}
      <Panel />
      <Drop />
      <Help />
      <Spoken />
    </div>
  );
}

if (!unpack()) start();
effect(() => {
  document.documentElement.dataset["theme"] = isDark() ? "dark" : "light";
});
effect(() => {
  if (!standalone.value) document.title = drawing.value ? `${drawing.value.name} · wiggleroom` : "wiggleroom";
});
listen();
render(<Page />, document.getElementById("page")!);
