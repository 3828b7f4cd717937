import assert from "node:assert/strict";
import { test } from "node:test";
import { isDesign } from "../src/keep.ts";
import { extraOf, begin, design, setExtras } from "../src/design.ts";

const GOOD = { gap: 1, extra: { a: 0.1 }, fixed: ["a"], glue: [["b", "c"]], goals: [{ part: "b", direction: [1, 0], point: null }, { part: "c", turn: "cw" }] };

test("a design is one as far as its form goes", () => {
  assert.ok(isDesign(GOOD));
  assert.ok(isDesign({ ...GOOD, goals: "closer", extra: {} }));
  assert.ok(isDesign({ ...GOOD, gaps: [["a", "b", 0.2]] }));
  for (const gaps of [null, [["a", "b"]], [["a", "b", -1]], [["a", 1, 0.2]]]) assert.ok(!isDesign({ ...GOOD, gaps }));
  const wrong = [null, undefined, "1", [], {}, { ...GOOD, gap: null }, { ...GOOD, gap: "1" }, { ...GOOD, gap: -1 }, { ...GOOD, extra: null }, { ...GOOD, extra: { a: "x" } },
    { ...GOOD, fixed: "a" }, { ...GOOD, fixed: [1] }, { ...GOOD, glue: [["a"], [1]] }, { ...GOOD, glue: ["ab"] }, { ...GOOD, goals: 5 }, { ...GOOD, goals: [{}] },
    { ...GOOD, goals: [{ part: "b", direction: "+x" }] }];
  for (const one of wrong) assert.ok(!isDesign(one), JSON.stringify(one));
});

test("extra gaps of parts that are called as what every object has", () => {
  begin({ gap: 1, extra: {}, fixed: [], glue: [], goals: [] });
  for (const name of ["constructor", "__proto__"]) {
    assert.equal(extraOf(name), 0);
    setExtras([name], 0.2);
    assert.equal(extraOf(name), 0.2);
  }
  assert.deepEqual(JSON.parse(JSON.stringify(design.value.extra)), JSON.parse('{"constructor": 0.2, "__proto__": 0.2}'));
  setExtras(["__proto__"], 0);
  assert.deepEqual(Object.keys(design.value.extra), ["constructor"]);
});
