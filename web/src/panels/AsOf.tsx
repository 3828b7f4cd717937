/** Says where what a panel lists is not the present answer, or not yet all of it. */

import type { FlexReply } from "../protocol.ts";
import { type About, current } from "../state.ts";

export function AsOf({ about }: { about: About<FlexReply> }) {
  if (current(about) && about.reply.settled) return null;
  return <p class="quiet" role="status">{current(about) ? "These belong to the motion found so far." : "These are of the answer before."}</p>;
}
