/** What needs three.js, as one bundle: the free space of a pair, the page of an assembly in space, and its live stage. */

import "./solid3d.ts";
export { show, type SpaceView } from "./space3d.ts";
export { openStage, type SolidView } from "./stage3d.ts";
