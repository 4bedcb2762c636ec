// The example with three.js in a browser: fewer draw calls, and the same pictures.
import assert from "node:assert/strict";
import { execFile } from "node:child_process";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { dirname, extname, join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";

const folder = (name) => dirname(fileURLToPath(import.meta.resolve(name)));
const roots = {
  casca: folder("casca"),
  three: join(folder("three"), ".."),
  example: fileURLToPath(new URL("../example", import.meta.url)),
};
const types = { ".html": "text/html", ".js": "text/javascript", ".mjs": "text/javascript", ".wasm": "application/wasm" };

test("the city in three.js has fewer draw calls and the same pictures", { timeout: 240_000 }, async () => {
  const missing = [];
  const server = createServer(async (request, response) => {
    const [, root, ...path] = new URL(request.url, "http://localhost").pathname.split("/");
    try {
      const bytes = await readFile(join(roots[root], ...path));
      response.writeHead(200, { "content-type": types[extname(request.url)] ?? "text/plain" }).end(bytes);
    } catch {
      missing.push(request.url);
      response.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  const url = `http://127.0.0.1:${server.address().port}/example/index.html`;
  const flags = ["--headless", "--no-sandbox", "--disable-gpu-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
  const run = promisify(execFile);
  const options = { timeout: 200_000, maxBuffer: 1 << 26 };
  const shot = process.env.CASCA_SCREENSHOT ? [`--screenshot=${process.env.CASCA_SCREENSHOT}`, "--window-size=900,760"] : ["--dump-dom"];
  const { stdout, stderr } = await run("chromium", [...flags, "--virtual-time-budget=60000", "--enable-logging=stderr", ...shot, url], options);
  server.close();
  if (process.env.CASCA_SCREENSHOT) return;
  // Pages say errors and warnings on the console.
  const console_lines = stderr.split("\n").filter((line) => line.includes(":CONSOLE"));
  const ours = console_lines.filter((line) => !line.includes("GPU stall due to ReadPixels"));
  assert.deepEqual([ours, missing], [[], []]);
  const attribute = /data-said="([^"]*)"/.exec(stdout);
  assert(attribute, stdout.slice(0, 2000));
  const said = JSON.parse(attribute[1].replaceAll("&quot;", '"'));
  console.log(said);
  assert.equal(said.differing, 0);
  assert(said.before > 100 && said.after > 1 && said.after * 3 < said.before);
});
