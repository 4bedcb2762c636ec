// The viewer's page in a browser: its pictures beside the desktop's, its controls, bad input and
// memory. `.ci/page` runs it in a folder with web/index.html and the desktop's pictures.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { PNG } from "pngjs";
import puppeteer from "puppeteer-core";

const page_url = pathToFileURL(process.env.CASCA_PAGE);
const pictures = process.env.CASCA_PICTURES;
const [width, height] = [640, 360];
// Chromium has either on a machine without a graphics processor, but not both at once.
const flags = {
  webgl: ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  webgpu: ["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-features=Vulkan", "--use-vulkan=swiftshader", "--use-angle=vulkan"],
};
const browsers = {};

before(async () => {
  for (const way of ["webgl", "webgpu"]) {
    const args = ["--no-sandbox", "--disable-gpu-sandbox", ...flags[way]];
    browsers[way] = await puppeteer.launch({ executablePath: process.env.CASCA_BROWSER, protocolTimeout: 300_000, args });
  }
});
after(() => Promise.all(Object.values(browsers).map((browser) => browser.close())));

// Opens the page, and closes it after the work; nothing may be said on its console.
async function open(search, work, way = "webgl") {
  const page = await browsers[way].newPage();
  const said = [];
  page.on("console", (message) => {
    if (["error", "warn"].includes(message.type())) said.push(message.text());
  });
  page.on("pageerror", (why) => said.push(String(why)));
  await page.setViewport({ width, height, deviceScaleFactor: 1 });
  await page.goto(`${page_url}?${search}`);
  try {
    await work(page);
  } finally {
    await page.close();
  }
  // What Chromium says of itself: that it reads pixels for a picture, and that it has no WebGPU.
  const ours = said.filter((text) => !/GPU stall due to ReadPixels|No available adapters/.test(text));
  assert.deepEqual(ours, []);
}

const reports = (page, count) => page.waitForFunction((count) => casca.reports >= count, { timeout: 120_000 }, count);
const told = (page, kind) => page.evaluate((kind) => casca.told[kind], kind);
const set = (page, dial, value) => page.evaluate((dial, value) => casca.viewer.set(dial, value), dial, value);
const status = (page) => page.$eval("#status", (element) => element.textContent);
// Waits for some more reports: what was ordered is done and drawn.
const later = async (page, count = 2) => reports(page, (await page.evaluate(() => casca.reports)) + count);
// Waits until what the page says holds.
const until = (page, condition, ...values) => page.waitForFunction(condition, { timeout: 60_000 }, ...values);

// The share of pixels with a channel that differs by more than a tenth.
function differing(a, b) {
  assert.deepEqual([a.width, a.height], [b.width, b.height]);
  let count = 0;
  for (let i = 0; i < a.data.length; i += 4) {
    if ([0, 1, 2].some((channel) => Math.abs(a.data[i + channel] - b.data[i + channel]) > 25)) count += 1;
  }
  return count / (a.width * a.height);
}
// A picture; with `beside`, of the part beside the panel, whose numbers change.
const shot = async (page, beside) => {
  const clip = beside ? { x: 350, y: 0, width: 290, height: 240 } : undefined;
  return PNG.sync.read(Buffer.from(await page.screenshot({ clip })));
};
const picture = (name) => PNG.sync.read(readFileSync(`${pictures}/${name}.png`));

for (const way of ["webgl", "webgpu"]) {
  test(`${way}: pictures are those of the desktop`, { timeout: 300_000 }, async () => {
    for (const [scene, frame] of [["city", 40], ["rooms", 90]]) {
      await open(`run=view+${scene}+--at+${frame}&bare`, async (page) => {
        await reports(page, 3);
        assert((await told(page, "opened")).device.includes(way === "webgl" ? "gl" : "webgpu"));
        const [ours, desktop] = [await shot(page), picture(`${scene}-00${frame}-point`)];
        const share = differing(ours, desktop);
        const other = differing(ours, picture(`${scene}-0005-point`));
        console.log(`${way}, ${scene}: ${(100 * share).toFixed(3)} % of pixels differ from the desktop's, ${(100 * other).toFixed(1)} % from another frame's`);
        assert(share < 0.005, `${share}`);
        assert(other > 0.1, `${other}`);
      }, way);
    }
  });

  test(`${way}: a city from above, with what is culled; and what its keys and settings do`, { timeout: 300_000 }, async () => {
    await open("", async (page) => {
      await reports(page, 3);
      const first = await told(page, "report");
      const [, shown, all] = /drawn +(\d+) of (\d+) objects/.exec(first.lines[1]);
      assert(Number(shown) > 10 && Number(shown) * 2 < Number(all), first.lines[1]);
      assert(first.legend.some(({ text }) => /hidden|culled/.test(text)), JSON.stringify(first.legend));
      assert.match(await page.$eval("#story", (element) => element.textContent), /not drawn/);
      // Nothing is lost.
      await set(page, "compare every frame with an item buffer (C)", 1);
      await until(page, () => casca.told.report.lines.some((line) => /objects lost  0$/.test(line)));
      const check = (await told(page, "report")).lines.find((line) => line.startsWith("visible in pixels"));
      assert(Number(/pixels +(\d+)/.exec(check)[1]) > 10, check);
      await set(page, "compare every frame with an item buffer (C)", 0);
      // Keys go to the picture.
      await page.focus("#picture");
      await page.keyboard.press("b");
      await until(page, () => casca.told.report.dials.some(({ name, on }) => name.includes("from above") && !on));
      await page.keyboard.press("Space");
      await later(page);
      // Slow machines need some more frames.
      const changes = async (before, what) => {
        for (let tries = 0; tries < 20; tries++) {
          await later(page);
          if (differing(before, await shot(page, true)) > 0.02) return;
        }
        assert.fail(what);
      };
      const before = await shot(page, true);
      await page.keyboard.down("w");
      await changes(before, "W flies");
      await page.keyboard.up("w");
      // A drag looks around.
      await set(page, "pause (Space)", 1);
      await later(page);
      const still = await shot(page, true);
      await later(page);
      assert.equal(differing(still, await shot(page, true)), 0, "a pause");
      await page.mouse.move(450, 100);
      await page.mouse.down();
      await later(page);
      await page.mouse.move(560, 130, { steps: 5 });
      await later(page);
      await page.mouse.up();
      await changes(still, "a drag turns");
      await page.keyboard.press("m");
      await until(page, () => casca.told.report.lines[0].endsWith("cell"));
    }, way);
  });

  test(`${way}: every system that the adapter can run starts`, { timeout: 600_000 }, async () => {
    await open("bare", async (page) => {
      await reports(page, 1);
      const { systems } = await told(page, "opened");
      const names = systems.map(({ name }) => name);
      assert.deepEqual(names, ["view", "plane", "points", "light", "lines", "fur"]);
      const refused = systems.filter(({ refused }) => refused).map(({ name }) => name);
      assert.deepEqual(refused, way === "webgl" ? ["points", "light", "lines", "fur"] : []);
      // Smaller than by default: processors draw here.
      await page.setViewport({ width: 320, height: 180, deviceScaleFactor: 1 });
      const smaller = { points: "--panes points,hpr --spacing 0.3", light: "cornell-point --resolution 16", lines: "--lines 60 --samples 8", fur: "--layers 2" };
      for (const name of names.filter((name) => !refused.includes(name))) {
        const [count, begun] = [await page.evaluate(() => casca.reports), Date.now()];
        await page.evaluate((words) => casca.viewer.show(words), `${name} ${smaller[name] ?? ""}`);
        await page.waitForFunction((count) => casca.reports > count + 1 && !casca.starting && casca.told.report.lines.length > 0, { timeout: 180_000 }, count).catch((why) => assert.fail(`${name}: ${why}`));
        assert.equal(await status(page), "", name);
        assert((await told(page, "report")).dials.length > 0, name);
        // Something is drawn.
        const colours = new Set((await shot(page)).data);
        assert(colours.size > 20, name);
        console.log(`${way}, ${name}: ${((Date.now() - begun) / 1000).toFixed(1)} s`);
      }
    }, way);
  });
}

test("files of one's own are shown, and others refused", { timeout: 120_000 }, async () => {
  await open("", async (page) => {
    await reports(page, 1);
    const file = (name, bytes) => page.evaluate(async (name, bytes) => {
      await open_file(new File([new Uint8Array(bytes)], name));
      return casca.reports;
    }, name, [...bytes]);
    for (const bytes of [[], Buffer.from("no scene"), glb().subarray(0, 60)]) {
      await file("broken.glb", bytes);
      assert.match(await status(page), /broken: is not a valid|broken: /);
    }
    const count = await file("walls.glb", glb());
    await until(page, (count) => casca.reports > count + 1 && casca.told.report.lines[0].startsWith("walls"), count);
    const { lines } = await told(page, "report");
    assert.match(lines[1], /of 2 objects/);
    assert.equal(await status(page), "");
  });
});

test("wrong words, wrong numbers and unknown names change nothing", { timeout: 120_000 }, async () => {
  await open("run=hair", async (page) => {
    await until(page, () => document.getElementById("status").textContent.includes("none of view"));
  });
  await open("", async (page) => {
    await reports(page, 1);
    const refused = await page.evaluate(() => {
      const said = [];
      for (const words of ["", "hair", "view --size 0x9", "view none.glb", "lines --samples -1"]) {
        try { casca.viewer.show(words); } catch (why) { said.push(why.message); }
      }
      return said;
    });
    assert.equal(refused.length, 5);
    const before = (await told(page, "report")).dials;
    await page.evaluate(() => {
      const { viewer } = casca;
      for (const value of [NaN, Infinity, -1, 99, 0.5]) viewer.set("culled by", value);
      viewer.set("no such dial", 1);
      viewer.hold("KeyZ", true);
      viewer.turn(NaN, Infinity);
    });
    await later(page);
    assert.deepEqual((await told(page, "report")).dials, before);
  });
});

test("a lost context is said, with a way to start again", { timeout: 120_000 }, async () => {
  await open("", async (page) => {
    await reports(page, 1);
    await page.evaluate(() => canvas.getContext("webgl2").getExtension("WEBGL_lose_context").loseContext());
    await until(page, () => document.getElementById("status").textContent.includes("lost"));
    await Promise.all([page.waitForNavigation(), page.click("#status button")]);
    await reports(page, 1);
    assert.equal(await status(page), "");
  });
});

test("keyboards reach all controls, which have names for screen readers", { timeout: 120_000 }, async () => {
  await open("", async (page) => {
    await reports(page, 1);
    const nodes = await page.$$eval("canvas, button, input, select, summary", (all) => all.filter((e) => e.checkVisibility()).length);
    const reached = new Set();
    for (let i = 0; i < 3 * nodes && reached.size < nodes; i++) {
      await page.keyboard.press("Tab");
      reached.add(await page.evaluate(() => {
        const all = [...document.querySelectorAll("canvas, button, input, select, summary")];
        return all.indexOf(document.activeElement);
      }));
      reached.delete(-1);
    }
    assert.equal(reached.size, nodes);
    const tree = await page.accessibility.snapshot({ interestingOnly: true });
    const controls = [];
    const walk = (node) => {
      if (["button", "checkbox", "combobox", "slider", "application", "DisclosureTriangle"].includes(node.role)) controls.push(node);
      node.children?.forEach(walk);
    };
    walk(tree);
    assert(controls.length >= 15, JSON.stringify(controls.map(({ role, name }) => [role, name])));
    for (const { role, name } of controls) assert(name, `a ${role} without a name`);
    // By the keyboard alone: a box is checked, a button flies.
    await page.focus("#dials input[type=checkbox]");
    await page.keyboard.press("Space");
    await until(page, () => casca.told.report.dials.some(({ name, on }) => name.includes("from above") && !on));
    await set(page, "pause (Space)", 1);
    await later(page);
    const before = await shot(page, true);
    await page.focus("[data-key=KeyW]");
    await page.keyboard.down("Enter");
    await later(page, 3);
    await page.keyboard.up("Enter");
    assert(differing(before, await shot(page, true)) > 0.02, "the button flies");
  });
});

test("fingers turn and fly", { timeout: 120_000 }, async () => {
  await open("run=view+city+--at+40&bare", async (page) => {
    await reports(page, 2);
    const before = await shot(page);
    const finger = await page.touchscreen.touchStart(300, 180);
    for (let i = 1; i <= 8; i++) await finger.move(300 + 12 * i, 180);
    await later(page);
    const turned = await shot(page);
    assert(differing(before, turned) > 0.02, "one finger turns");
    const second = await page.touchscreen.touchStart(420, 180);
    await second.move(560, 180);
    await later(page, 3);
    await second.end();
    await finger.end();
    assert(differing(turned, await shot(page)) > 0.02, "two fingers fly");
  });
});

test("memory is flat over a thousand frames", { timeout: 600_000 }, async () => {
  await open("run=view+rooms&bare", async (page) => {
    const frames = (count) => page.evaluate((count) => new Promise((done) => {
      const start = performance.now();
      const next = () => (count-- > 0 ? requestAnimationFrame(next) : done(performance.now() - start));
      next();
    }), count);
    // So small that drawing is no matter, and for once around the whole path.
    await page.setViewport({ width: 160, height: 90, deviceScaleFactor: 1 });
    await reports(page, 2);
    await frames(500);
    const before = await page.evaluate(() => casca.memory());
    const milliseconds = await frames(1000);
    const grown = (await page.evaluate(() => casca.memory())) - before;
    const lines = (await told(page, "report")).lines.slice(1, 4).join("; ");
    console.log(`1000 frames in ${(milliseconds / 1000).toFixed(1)} s; memory ${before}, grown by ${grown} bytes; ${lines}`);
    assert(grown <= 65536, `${grown}`);
  });
});

// A floor and a wall as glTF: two quads by one mesh each.
function glb() {
  const quad = (corners) => corners.flatMap(([x, y, z]) => [x, y, z]);
  const positions = new Float32Array([...quad([[-5, 0, -5], [5, 0, -5], [5, 0, 5], [-5, 0, 5]]), ...quad([[-5, 0, 0], [5, 0, 0], [5, 3, 0], [-5, 3, 0]])]);
  const indices = new Uint16Array([0, 1, 2, 0, 2, 3]);
  const binary = Buffer.concat([Buffer.from(positions.buffer), Buffer.from(indices.buffer)]);
  const accessor = (first, min, max) => ({ bufferView: 0, byteOffset: 48 * first, componentType: 5126, count: 4, type: "VEC3", min, max });
  const document = {
    asset: { version: "2.0" },
    scenes: [{ nodes: [0, 1] }], scene: 0,
    nodes: [{ mesh: 0, name: "floor" }, { mesh: 1, name: "wall" }],
    meshes: [0, 1].map((position) => ({ primitives: [{ attributes: { POSITION: position }, indices: 2 }] })),
    accessors: [accessor(0, [-5, 0, -5], [5, 0, 5]), accessor(1, [-5, 0, 0], [5, 3, 0]), { bufferView: 1, componentType: 5123, count: 6, type: "SCALAR" }],
    bufferViews: [{ buffer: 0, byteLength: 96 }, { buffer: 0, byteOffset: 96, byteLength: 12 }],
    buffers: [{ byteLength: binary.length }],
  };
  let text = JSON.stringify(document);
  text += " ".repeat((4 - (text.length % 4)) % 4);
  const chunk = (kind, bytes) => {
    const head = Buffer.alloc(8);
    head.writeUInt32LE(bytes.length, 0);
    head.write(kind, 4, "latin1");
    return Buffer.concat([head, bytes]);
  };
  const chunks = Buffer.concat([chunk("JSON", Buffer.from(text)), chunk("BIN\0", binary)]);
  const head = Buffer.alloc(12);
  head.write("glTF", 0, "latin1");
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + chunks.length, 8);
  return Buffer.concat([head, chunks]);
}
