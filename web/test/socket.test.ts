import assert from "node:assert/strict";
import { test } from "node:test";
import { readFrames, type Reply } from "../src/protocol.ts";
import { Latest, Socket } from "../src/socket.ts";

test("answers to a request that goes on are wanted, and to those before it since it began", () => {
  const latest = new Latest();
  const other = latest.ask("drag");
  const first = latest.ask("drag");
  const second = latest.ask("drag", true);
  assert.ok(!latest.wanted("drag", other) && latest.wanted("drag", first) && latest.wanted("drag", second));
  latest.forget("drag");
  assert.ok(!latest.wanted("drag", first) && !latest.wanted("drag", second));
  const anew = latest.ask("drag", true);
  assert.ok(!latest.wanted("drag", second) && latest.wanted("drag", anew));
});

test("only the newest request of a kind is wanted, other kinds are left alone", () => {
  const latest = new Latest();
  const [a, check, b] = [latest.ask("flex"), latest.ask("check"), latest.ask("flex")];
  assert.ok(a < check && check < b);
  assert.ok(!latest.wanted("flex", a));
  assert.ok(latest.wanted("flex", b) && latest.wanted("check", check));
  latest.forget("check");
  assert.ok(!latest.wanted("check", check));
});

function motions(id: number, values: number[]): ArrayBuffer {
  const buffer = new ArrayBuffer(16 + 4 * values.length);
  const head = new DataView(buffer);
  [id, values.length / 3, 1, 0].forEach((v, i) => head.setUint32(4 * i, v, true));
  new Float32Array(buffer, 16).set(values);
  return buffer;
}

test("what a study tells before its own answer is wanted as the study is", () => {
  const latest = new Latest();
  const [flex, sample] = [latest.ask("flex"), latest.ask("sample")];
  assert.deepEqual([latest.kindOf(flex), latest.kindOf(sample)], ["flex", "sample"]);
  latest.ask("sample");
  assert.equal(latest.kindOf(sample), undefined);
});

test("a frame of motions says what it holds; a torn one is nothing", () => {
  const read = readFrames(motions(7, [1, 2, 3, 4, 5, 6]))!;
  assert.deepEqual([read.id, read.frames.k, read.frames.n], [7, 2, 1]);
  assert.deepEqual([...read.frames.data], [1, 2, 3, 4, 5, 6]);
  assert.equal(readFrames(motions(7, [1, 2, 3]).slice(0, 20)), null);
});

/** Stands in for the browser's socket, as far as the page uses it. */
class Wire {
  static OPEN = 1;
  static last: Wire;
  readyState = 1;
  binaryType = "";
  sent: { id: number; kind: string }[] = [];
  onopen?: () => void;
  onmessage?: (event: { data: unknown }) => void;
  constructor() {
    Wire.last = this;
  }
  send(text: string): void {
    this.sent.push(JSON.parse(text));
  }
}

test("an answer that comes late is dropped, with its motions", () => {
  Object.assign(globalThis, { WebSocket: Wire });
  const heard: [string, number, number[]][] = [];
  const socket = new Socket("ws://here", {
    line: () => undefined,
    reply: (reply: Reply, paths) => heard.push([reply.kind, (reply as { id: number }).id, paths.flatMap((path) => [...path.data])]),
  });
  const design = { gap: 1, extra: {}, fixed: [], glue: [], goals: [] };
  const [first, second] = [socket.ask("flex", { design, thorough: false }), socket.ask("flex", { design, thorough: false })];
  const hear = (data: unknown): void => Wire.last.onmessage!({ data });
  hear(motions(first, [1, 1, 1]));
  hear(JSON.stringify({ kind: "flex", id: first }));
  hear(motions(second, [2, 2, 2]));
  hear(JSON.stringify({ kind: "progress", id: second, kind_of: "flex" }));
  hear(JSON.stringify({ kind: "flex", id: second }));
  assert.deepEqual(heard, [["progress", second, []], ["flex", second, [2, 2, 2]]]);
  socket.cancel("flex");
  assert.deepEqual(Wire.last.sent.map((one) => one.kind), ["flex", "flex", "cancel"]);
});
