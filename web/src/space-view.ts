/** What needs three.js, as one bundle: the free space of a pair, and the page of an assembly in space. */

import "./solid3d.ts";
export { show, type SpaceView } from "./space3d.ts";
