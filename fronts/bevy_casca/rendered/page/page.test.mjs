// The town that Bevy draws, in a browser: casca culls, and the picture stays the same. `.ci/bevy-page`
// runs it in a folder with the page.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { PNG } from "pngjs";
import puppeteer from "puppeteer-core";

const [width, height] = [960, 540];
let browser;
before(async () => {
  const args = ["--no-sandbox", "--disable-gpu-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
  browser = await puppeteer.launch({ executablePath: process.env.CASCA_BROWSER, protocolTimeout: 300_000, args });
});
after(() => browser.close());

// The share of values that differ by more than rounding, to the right of the words and below the view from above.
function differing(a, b) {
  let [count, all] = [0, 0];
  for (let y = Math.ceil(height * 0.5); y < height; y++) {
    for (let x = 440; x < width; x++) {
      for (let channel = 0; channel < 3; channel++, all++) {
        const i = (y * width + x) * 4 + channel;
        count += Math.abs(a.data[i] - b.data[i]) > 2;
      }
    }
  }
  return count / all;
}

test("Bevy draws a town in a page, and casca changes no pixel of it", { timeout: 600_000 }, async () => {
  const page = await browser.newPage();
  const said = [];
  page.on("console", (message) => {
    if (["error", "warn"].includes(message.type())) said.push(message.text());
  });
  await page.setViewport({ width, height, deviceScaleFactor: 1 });
  await page.goto(pathToFileURL(process.env.CASCA_PAGE));
  const title = () => page.$eval("#picture", (canvas) => canvas.getAttribute("alt") ?? "");
  // Some frames; one takes seconds without a graphics processor.
  const frames = (count) => page.evaluate(async (count) => {
    while (count-- > 0) await new Promise(requestAnimationFrame);
  }, count);
  const culls = async (who) => {
    const wanted = (who) => new RegExp(`${who}.*, [1-9]\\d* of`).test(document.querySelector("#picture").getAttribute("alt") ?? "");
    await page.waitForFunction(wanted, { timeout: 300_000, polling: 100 }, who);
    // The title tells of the frame before, and the set of a frame is drawn by the next one.
    await frames(5);
    const [, drawn, all] = (await title()).match(/(\d+) of (\d+) things/).map(Number);
    return { drawn, all, picture: PNG.sync.read(Buffer.from(await page.screenshot())) };
  };
  await culls("casca culls");
  const start = await culls("casca culls");
  await page.keyboard.press("Space", { delay: 500 });
  const with_casca = await culls("casca culls");
  await page.keyboard.press("F1", { delay: 500 });
  const without = await culls("Bevy culls");
  if (process.env.CASCA_SCREENSHOT) {
    await page.keyboard.press("F1", { delay: 500 });
    await culls("casca culls");
    await page.screenshot({ path: process.env.CASCA_SCREENSHOT });
  }
  const [same, other] = [without, start].map(({ picture }) => differing(with_casca.picture, picture));
  console.log(`casca draws ${with_casca.drawn} of ${with_casca.all} things in view, Bevy ${without.drawn}`);
  console.log(`${(100 * same).toFixed(4)} % of values differ; ${(100 * other).toFixed(1)} % some frames before`);
  assert(with_casca.drawn * 2 < without.drawn, "casca culls");
  assert(other > 0.02, "the town moves");
  assert(same < 0.0001, "casca changes nothing");
  assert.deepEqual(said.filter((text) => !/GPU stall due to ReadPixels/.test(text)), []);
  await page.close();
});
