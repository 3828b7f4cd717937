/** What is seen before there is a drawing: a place to drop one, samples to press, files opened before. */

import { useSignal } from "@preact/signals";
import { forgetDesigns, forgetRecent, recent } from "../keep.ts";
import type { SampleEntry } from "../protocol.ts";
import { make, openAs } from "../session.ts";
import { atStart, drawing, findings, hello, line, notice, served, unopened } from "../state.ts";
import { short } from "../words.ts";
import { Button } from "./Button.tsx";

const FIRST = { pattern: "chain", nx: 4, ny: 1, joint: "swallowtail", pitch: 20, sizes: {} } as const;

export function Start() {
  const files = useSignal(recent());
  const samples = hello.value?.samples ?? [];
  const wrong = [...unopened.value, ...findings.value.map((one) => one.words)];
  return (
    <section class="start" aria-label="start">
      <div class="startpage">
        {drawing.value && <Button icon="undo" label={`Back to ${drawing.value.name}`} keyName="Escape" class="backto" onClick={() => (atStart.value = false)}>Back to {short(drawing.value.name, 40)}</Button>}
        <p class="lead">How far loose, interlocking parts can move, what stops them, and whether they come apart.</p>
        <section class="dropzone">
          <p class="big">Drop a drawing here</p>
          <p>SVG, DXF, LightBurn, a voxel puzzle or an assembly file (JSON).</p>
          <label class="button main worded" for="file"><span>Choose a file</span></label>
          <p class="quiet">It stays on this machine.</p>
        </section>
        {line.value !== "open" && <p class="quiet" role="status">{line.value === "connecting" ? "Reaching the server…" : "The server does not answer; this page tries again by itself."}</p>}
        {notice.value && <p role="status">{notice.value}</p>}
        {wrong.length > 0 && <div class="notice bad" role="alert"><ul>{wrong.map((words) => <li key={words}>{words}</li>)}</ul></div>}
        {served.value && served.value !== drawing.value?.name && (
          <p><Button icon="open" label={`Open ${served.value}, the file of the command`} onClick={() => openAs({ name: served.value, served: true })}>{short(served.value, 40)}, the file of the command</Button></p>
        )}
        {files.value.length > 0 && (
          <section>
            <header><h2>Opened before</h2><button type="button" class="link" onClick={() => { forgetRecent(); forgetDesigns(); files.value = []; }}>forget them</button></header>
            <ul class="recents">
              {files.value.map((one) => (
                <li key={one.name}>
                  <button type="button" class="recent" title={one.name} onClick={() => openAs({ name: one.name, data: one.data, ...(one.reading && { reading: one.reading }) })}>
                    <span>{short(one.name, 40)}</span><span class="quiet">{new Date(one.when).toLocaleDateString()}</span>
                  </button>
                </li>
              ))}
            </ul>
          </section>
        )}
        {samples.length > 0 && (
          <section>
            <header><h2>Or press a sample</h2><Button label="Make blocks with joints, whose sizes are set on the page" onClick={() => make(FIRST)} class="small">Make joints</Button></header>
            <ul class="samples">{samples.map((one) => <li key={one.name}><SampleCard sample={one} /></li>)}</ul>
          </section>
        )}
      </div>
    </section>
  );
}

function SampleCard({ sample: { name, words, count, picture, pulled } }: { sample: SampleEntry }) {
  const path = picture.flat().map((ring) => `M${ring.map(([x, y]) => `${x} ${100 - y}`).join("L")}Z`).join("");
  const [last, first] = [picture.at(-1)!, picture[0]!].map((rings) => rings.map((ring) => `M${ring.map(([x, y]) => `${x} ${100 - y}`).join("L")}Z`).join(""));
  const xs = picture.flat(2).map(([, y]) => y);
  const high = Math.max(...xs);
  return (
    <button type="button" class="sample" onClick={() => openAs({ name, sample: true })}>
      <svg viewBox={`-2 ${98 - high} 104 ${high + 4}`} aria-hidden="true">
        <path class="part" d={path} />{pulled && <><path class="part fixed" d={first} /><path class="part pulled" d={last} /></>}
      </svg>
      <span class="strong">{name}</span>
      <span class="quiet">{words}</span><span class="quiet">{count} parts</span>
    </button>
  );
}
