/** A canvas of three.js that can be reached by keys, and a camera with z upwards. */

import { PerspectiveCamera, WebGLRenderer } from "three";

export function canvas3d(label: string): { renderer: WebGLRenderer; camera: PerspectiveCamera } {
  const renderer = new WebGLRenderer({ antialias: true, alpha: true });
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  renderer.domElement.tabIndex = 0;
  renderer.domElement.setAttribute("role", "application");
  renderer.domElement.setAttribute("aria-label", label);
  const camera = new PerspectiveCamera(30, 1, 0.001, 1000);
  camera.up.set(0, 0, 1);
  return { renderer, camera };
}
