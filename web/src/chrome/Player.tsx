/** Under the canvas: play, the place on the path, magnification, and the zoom. */

import { chosenFactor, FACTORS, place, play, playing, shown, suggested } from "../motion.ts";
import { back, backToRest, keepBeside, showMode } from "../session.ts";
import { fitAll, zoomBy } from "../stage/camera.ts";
import { measuring, stopMeasuring } from "../stage/measure.ts";
import { answer, standalone, drawing, exploded, modes, section } from "../state.ts";
import { inSpace } from "../design.ts";
import { canKeep, kept } from "../stage/kept.ts";
import { lassoing } from "../stage/lasso.ts";
import { Button } from "./Button.tsx";

export function Player() {
  if (!drawing.value) return null;
  const { frames, what } = shown.value;
  const film = frames !== null && frames.k > 1;
  const other = what !== "answer" && what !== "rest" && what !== "between";
  return (
    <div class="player">
      <div class="group film" hidden={!film && !other}>
        {film && (
          <>
            <Button icon={playing.value ? "pause" : "play"} label={playing.value ? "Pause" : "Play"} keyName="Space" onClick={() => play(!playing.value)} />
            <input
              type="range" min="0" max="1000" value={Math.round(place.value * 1000)} aria-label="place on the path from rest"
              aria-valuetext={`${Math.round(place.value * 100)} %`}
              onInput={(event) => {
                play(false);
                place.value = Number(event.currentTarget.value) / 1000;
              }}
            />
            <output>{place.value <= 0 ? "rest" : `${Math.round(place.value * 100)} %`}</output>
          </>
        )}
        {what === "mode" && modes.value && modes.value.paths.length > 1 && (
          <span class="modes" role="group" aria-label="freedoms">
            {modes.value.paths.map((path, i) => <Button key={i} label={`Freedom ${i + 1}`} onClick={() => showMode(i)} pressed={path === frames} class="small">{i + 1}</Button>)}
          </span>
        )}
        {other && <Button icon="rest" label={answer.value ? "Back to the answer" : "Back to rest"} keyName="Escape" onClick={back}>{answer.value ? "Answer" : "Rest"}</Button>}
        {what === "drag" && answer.value && <Button label="Bring all parts back to rest" keyName="Home" onClick={backToRest}>Rest</Button>}
      </div>
      <span class="spring" />
      {chosenFactor.value === 1 && suggested.value > 1 && what !== "rest" && (
        <Button label={`Draw the motion ${suggested.value} times as far; parts that touch pass through each other then`} class="small" onClick={() => (chosenFactor.value = suggested.value)}>Enlarge ×{suggested.value}</Button>
      )}
      <label class="group factor" title="how many times as far as in truth the motion is drawn">
        <span>motion</span>
        <select value={chosenFactor.value} aria-label="how many times as far as in truth the motion is drawn" onChange={(event) => (chosenFactor.value = Number(event.currentTarget.value))}>
          {FACTORS.map((f) => <option key={f} value={f}>×{f}{f === 1 ? " true" : ""}</option>)}
        </select>
      </label>
      {inSpace() && (
        <label class="group explode">
          <span>exploded</span>
          <input
            type="range" min="0" max="1.5" step="0.01" value={exploded.value} aria-label="exploded view" aria-valuetext={`${Math.round(exploded.value * 100)} %`}
            onInput={(event) => (exploded.value = Number(event.currentTarget.value))}
          />
        </label>
      )}
      {inSpace() && <Cut />}
      {!standalone.value && (
        <Button
          icon="pin" label={kept.value ? "Keep nothing beside" : "Keep this answer beside, to compare"} keyName="B" pressed={kept.value !== null}
          disabled={!kept.value && !canKeep()} onClick={() => (kept.value ? (kept.value = null) : keepBeside())}
        />
      )}
      {!inSpace() && <div class="group">
        {!standalone.value && <Button icon="lasso" label="Choose many: draw a line round them" keyName="L" pressed={lassoing.value} onClick={() => (lassoing.value = !lassoing.value)} />}
        <Button
          icon="measure" label="Measure: press two edges or corners" keyName="M" pressed={measuring.value}
          onClick={() => (measuring.value ? stopMeasuring() : (measuring.value = true))}
        />
      </div>}
      <div class="group zoom">
        <Button icon="minus" label="Zoom out" keyName="-" onClick={() => zoomBy(1 / 1.3)} />
        <Button icon="plus" label="Zoom in" keyName="+" onClick={() => zoomBy(1.3)} />
        <Button icon="fit" label="Fit the drawing" keyName="0" onClick={fitAll} />
      </div>
    </div>
  );
}

/** Where parts in space are cut through: across an axis, at a place along it. */
function Cut() {
  const { axis, at } = section.value ?? { axis: -1, at: 0.5 };
  return (
    <div class="group explode cut">
      <span aria-hidden="true">cut</span>
      <select value={axis} aria-label="cut across an axis, to see inside" onChange={(event) => {
        const to = Number(event.currentTarget.value);
        section.value = to < 0 ? null : { axis: to as 0 | 1 | 2, at };
      }}>
        <option value={-1}>none</option>
        {["x", "y", "z"].map((name, k) => <option key={name} value={k}>{name}</option>)}
      </select>
      {axis >= 0 && (
        <input
          type="range" min="0" max="1" step="0.005" value={at} aria-label="place of the cut" aria-valuetext={`${Math.round(at * 100)} %`}
          onInput={(event) => (section.value = { axis: axis as 0 | 1 | 2, at: Number(event.currentTarget.value) })}
        />
      )}
    </div>
  );
}
