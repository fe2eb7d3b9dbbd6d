// Bundles the extension, and with `--tests` its tests; writes down the licenses of the libraries that are in the
// bundle.
import { copyFile, mkdir, readdir, readFile, rm, writeFile } from "node:fs/promises";
import { build } from "esbuild";

const node = {
  bundle: true,
  platform: "node",
  format: "cjs",
  target: "node20",
  external: ["vscode"],
  mainFields: ["module", "main"],
  logLevel: "error",
};

await rm("dist", { recursive: true, force: true });
await mkdir("dist");
const { metafile } = await build({
  ...node,
  entryPoints: ["src/extension.ts"],
  outfile: "dist/extension.js",
  minify: true,
  legalComments: "none",
  metafile: true,
});
await build({
  entryPoints: ["src/bridge.ts"],
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  outfile: "dist/bridge.js",
  logLevel: "error",
});
await writeFile("dist/NOTICE", await notices(Object.keys(metafile.inputs)));
await copyFile("../../LICENSE", "LICENSE");

if (process.argv.includes("--tests")) {
  await rm("build", { recursive: true, force: true });
  const tests = (await readdir("test")).filter((name) => name.endsWith(".test.ts")).map((name) => `test/${name}`);
  // What finds its own files by where it is stays a package.
  const kept = { ...node, external: ["vscode", "vscode-oniguruma", "vscode-textmate", "@vscode/test-electron"] };
  await build({ ...kept, entryPoints: tests, outdir: "build/test" });
  await build({ ...kept, entryPoints: ["test/vscode/run.ts", "test/vscode/suite.ts"], outdir: "build/vscode" });
}

/** The licenses of the packages whose files are in the bundle. */
async function notices(inputs) {
  const packages = new Set(inputs.flatMap((path) => path.match(/.*node_modules\/(?:@[^/]+\/)?[^/]+/) ?? []));
  const parts = ["The extension is mjcompose's, Apache License 2.0. It has these libraries in it:\n"];
  for (const folder of [...packages].sort()) {
    const { name, version, license } = JSON.parse(await readFile(`${folder}/package.json`, "utf8"));
    const file = (await readdir(folder)).find((each) => /^licen[cs]e/i.test(each));
    if (!file) {
      throw new Error(`${name} has no license`);
    }
    parts.push(`${name} ${version}, ${license}\n\n${(await readFile(`${folder}/${file}`, "utf8")).trim()}\n`);
  }
  return parts.join(`\n${"-".repeat(80)}\n\n`);
}
