// Lets MaterialX itself read, validate and compile a document of `miebrdf export --format mtlx`.
//
//     materialx.mjs PROGRAM FOLDER
//
// Exit code 77 (skipped) where the npm package @needle-tools/materialx, its WebAssembly build, is
// not found (NODE_PATH).
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import { pathToFileURL } from "node:url";

const require = createRequire(import.meta.url);
let folder;
try {
  folder = path.join(path.dirname(require.resolve("@needle-tools/materialx/package.json")), "bin");
} catch {
  console.log("skipped: no @needle-tools/materialx in NODE_PATH");
  process.exit(77);
}
const [program, work] = process.argv.slice(2);
fs.mkdirSync(work, { recursive: true });
const module = path.join(work, "materialx_module.mjs");
fs.copyFileSync(path.join(folder, "JsMaterialXGenShader.js"), module);
Object.assign(globalThis, { require, __dirname: work, __filename: module });
const data = fs.readFileSync(path.join(folder, "JsMaterialXGenShader.data.txt"));
const mx = await (await import(pathToFileURL(module))).default({
  wasmBinary: fs.readFileSync(path.join(folder, "JsMaterialXGenShader.wasm")),
  getPreloadedPackage: () =>
    data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength),
});
const generator = mx.EsslShaderGenerator.create();
const context = new mx.GenContext(generator);
const library = mx.loadStandardLibraries(context);
let failures = 0;
const check = (fact, what) => {
  if (fact) return;
  console.log(`FAILED: ${what}`);
  failures += 1;
};
for (const options of [[], ["--acescg", "--boundary", "rough:0.2"]]) {
  const file = path.join(work, "material.mtlx");
  execFileSync(program, ["export", "--format", "mtlx", "--base", "hg:0.9,0.4 in index:1.5",
    "-o", file, ...options], { stdio: "ignore" });
  const document = mx.createDocument();
  document.importLibrary(library);
  await mx.readFromXmlString(document, fs.readFileSync(file, "utf8"), "");
  const message = {};
  check(document.validate(message), `validate: ${JSON.stringify(message)}`);
  const surface = document.getNodes().find((node) => node.getCategory() === "open_pbr_surface");
  const definition = surface.getNodeDef();
  check(definition, "a surface that its definition knows");
  if (!definition) continue;
  for (const input of surface.getInputs()) {
    const known = definition.getActiveInput(input.getName());
    check(known && known.getType() === input.getType(), `input ${input.getName()}`);
  }
  const material = document.getNodes().find((node) => node.getCategory() === "surfacematerial");
  const shader = generator.generate(material.getName(), material, context);
  check(shader.getSourceCode("pixel").length > 10000, "a shader");
}
console.log(`MaterialX ${mx.getVersionString ? mx.getVersionString() : ""}: ${failures} failures`);
process.exit(failures ? 1 : 0);
