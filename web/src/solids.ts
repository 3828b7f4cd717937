/** Solids as they come over the wire, made ready for drawing. */

import { fromBase64, type Solids, type Triple } from "./protocol.ts";

/** A surface about its reference point: corners x, y, z [mm] and triangles. */
export interface Surface { corners: Float32Array; triangles: Uint32Array }

const known = new WeakMap<Solids, Surface[]>();

/** The shapes of solids, each decoded once. */
export function surfacesOf(solids: Solids): Surface[] {
  let found = known.get(solids);
  if (!found) {
    found = solids.shapes.map(({ vertices, triangles }) => ({
      corners: new Float32Array(fromBase64(vertices).buffer), triangles: new Uint32Array(fromBase64(triangles).buffer),
    }));
    known.set(solids, found);
  }
  return found;
}

/** How far each part reaches from its reference point [mm]. */
export function reachOfSolids(solids: Solids): number[] {
  const far = surfacesOf(solids).map(({ corners }) => {
    let most = 0;
    for (let i = 0; i < corners.length; i += 3) most = Math.max(most, Math.hypot(corners[i]!, corners[i + 1]!, corners[i + 2]!));
    return most;
  });
  return solids.of.map((k) => far[k]!);
}

/** Box round all parts at rest [mm]. */
export function boxOf(solids: Solids): { low: Triple; high: Triple } {
  const surfaces = surfacesOf(solids);
  const low: Triple = [Infinity, Infinity, Infinity];
  const high: Triple = [-Infinity, -Infinity, -Infinity];
  solids.of.forEach((k, p) => {
    const { corners } = surfaces[k]!;
    corners.forEach((v, i) => {
      const at = v + solids.reference[p]![i % 3]!;
      low[i % 3] = Math.min(low[i % 3]!, at);
      high[i % 3] = Math.max(high[i % 3]!, at);
    });
  });
  return { low, high };
}
