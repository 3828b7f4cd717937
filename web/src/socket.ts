/** The line to the server: numbers requests, keeps the newest of each kind, drops what is older, comes back when it breaks. */

import { type Frames, type Kind, readFrames, type Reply, type Requests } from "./protocol.ts";

/** Latest wins: which request of a kind is the newest one, and whether an answer is still wanted. */
export class Latest {
  #next = 1;
  #newest = new Map<string, number>();
  #first = new Map<string, number>();

  /** Of a request that goes on where the one before is; answers to both are wanted. */
  ask(kind: string, goesOn = false): number {
    const id = this.#next++;
    if (!goesOn || !this.#newest.has(kind)) this.#first.set(kind, id);
    this.#newest.set(kind, id);
    return id;
  }
  wanted(kind: string, id: number): boolean {
    const newest = this.#newest.get(kind);
    return newest !== undefined && id <= newest && id >= this.#first.get(kind)!;
  }
  /** Kind of a request that is the newest of its kind. */
  kindOf(id: number): string | undefined {
    return [...this.#newest].find(([, newest]) => newest === id)?.[0];
  }
  newest(kind: string): number | undefined {
    return this.#newest.get(kind);
  }
  forget(kind: string): void {
    this.#newest.delete(kind);
  }
}

/** What a request is called: its kind, or the question that a study asks. */
export const nameOf = (kind: Kind, body: object): string => (kind === "study" && "of" in body ? String(body.of) : kind);

/** Kind of the request that a reply belongs to. */
export function requestOf(reply: Reply): string {
  switch (reply.kind) {
    case "opened": return "open";
    case "assembled": return "assemble";
    case "modes": return "wiggle";
    case "step": return "sweep";
    case "saved": return "save";
    case "progress": return reply.kind_of;
    case "study": return reply.of;
    case "failed": return reply.of;
    default: return reply.kind;
  }
}

export type Line = "connecting" | "open" | "broken" | "refused";

export interface Heard {
  reply(reply: Reply, paths: Frames[]): void;
  line(state: Line): void;
}

const PATIENCE = [200, 500, 1000, 2000, 4000];

export class Socket {
  #heard: Heard;
  #url: string;
  #socket: WebSocket | null = null;
  #latest = new Latest();
  #paths = new Map<number, Frames[]>();
  #tries = 0;
  #everOpen = false;

  constructor(url: string, heard: Heard) {
    this.#url = url;
    this.#heard = heard;
    this.#connect();
  }

  get ready(): boolean {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  /** Sends a request and gives its id; 0 while there is no line. */
  ask<K extends Kind>(kind: K, body: Requests[K], goesOn = false): number {
    if (!this.ready) return 0;
    const id = this.#latest.ask(nameOf(kind, body), goesOn);
    this.#socket!.send(JSON.stringify({ kind, id, ...body }));
    return id;
  }

  cancel(kind: string): void {
    const id = this.#latest.newest(kind);
    if (id === undefined) return;
    this.#latest.forget(kind);
    if (this.ready) this.#socket!.send(JSON.stringify({ kind: "cancel", id, of: kind }));
  }

  #connect(): void {
    if (!this.#tries) this.#heard.line("connecting");
    const socket = new WebSocket(this.#url);
    socket.binaryType = "arraybuffer";
    this.#socket = socket;
    socket.onopen = () => {
      this.#tries = 0;
      this.#everOpen = true;
      this.#heard.line("open");
    };
    socket.onmessage = (event: MessageEvent) => this.#hear(event.data);
    socket.onclose = (event) => {
      this.#paths.clear();
      const refused = event.code === 1008 || (!this.#everOpen && this.#tries > 3);
      this.#heard.line(refused ? "refused" : "broken");
      if (!refused) setTimeout(() => this.#connect(), PATIENCE[Math.min(this.#tries++, PATIENCE.length - 1)]);
    };
  }

  #hear(data: unknown): void {
    if (data instanceof ArrayBuffer) {
      const read = readFrames(data);
      if (read) this.#paths.set(read.id, [...(this.#paths.get(read.id) ?? []), read.frames]);
      return;
    }
    const reply = JSON.parse(String(data)) as Reply;
    if (!("id" in reply) || reply.id === 0) { // said without being asked
      this.#heard.reply(reply, []);
      return;
    }
    const paths = reply.kind === "progress" ? [] : (this.#paths.get(reply.id) ?? []);
    if (reply.kind !== "progress") this.#paths.delete(reply.id);
    const kind = this.#latest.kindOf(reply.id) ?? requestOf(reply); // a study may tell a better answer before it speaks of it
    if (this.#latest.wanted(kind, reply.id)) this.#heard.reply(reply, paths);
    for (const id of this.#paths.keys()) if (id < reply.id - 64) this.#paths.delete(id);
  }
}
