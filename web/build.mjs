// Builds the page into the Python package; with --tests the unit tests into out/web-tests.
// The page and the 3D view are two bundles without shared pieces, so that a standalone page can carry page.js alone.
import { copyFile, mkdir, readdir } from "node:fs/promises";
import { build } from "esbuild";

const here = new URL(".", import.meta.url).pathname;
const common = { bundle: true, target: "es2022", format: "esm", jsx: "automatic", jsxImportSource: "preact", logLevel: "warning" };

if (process.argv.includes("--tests")) {
  const tests = (await readdir(`${here}test`)).filter((name) => name.endsWith(".test.ts"));
  await build({
    ...common,
    entryPoints: tests.map((name) => `${here}test/${name}`),
    outdir: `${here}../out/web-tests`,
    outExtension: { ".js": ".mjs" },
    platform: "node",
  });
} else {
  const out = `${here}../src/wiggleroom/report/web`;
  await mkdir(out, { recursive: true });
  const page = { ...common, minify: true, legalComments: "none", charset: "utf8" };
  const banner = { js: "/* Built from web/src. Holds Preact and @preact/signals: MIT licence, (c) 2015-present Jason Miller, (c) 2022-present Preact Team. */" };
  await build({ ...page, banner, entryPoints: { page: `${here}src/main.tsx` }, outdir: out, external: ["./space-view.js"] });
  await build({ ...page, legalComments: "eof", entryPoints: { "space-view": `${here}src/space-view.ts` }, outdir: out });
  await build({ ...page, entryPoints: { page: `${here}src/page.css` }, outdir: out });
  await copyFile(`${here}index.html`, `${out}/index.html`);
}
