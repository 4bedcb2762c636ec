// Runs the program of this folder: node run.mjs FILE.wasm
import { readFileSync } from "node:fs";

const bytes = readFileSync(process.argv[2]);
const { instance } = await WebAssembly.instantiate(bytes, {});
const code = instance.exports.main(0, 0);
if (code !== 0) {
  console.error(code === 100 ? "the library refused something" : `look ${code} at the scene is not right`);
  process.exit(1);
}
console.log("the program is right as WebAssembly");
