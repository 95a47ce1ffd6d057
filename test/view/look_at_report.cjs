// SPDX-License-Identifier: BSD-3-Clause
// Opens a page of `rio replay --report` in a real browser, headless, without a network, and checks
// what a person would: node look_at_report.cjs PAGE.html FOLDER. Leaves screenshots in the folder.
// Needs playwright-core of npm (NODE_PATH) and Debian's chromium. Prints the time to open in ms.
const { chromium } = require("playwright-core");
const path = require("path");

const [file, folder] = process.argv.slice(2);
const fail = (what) => {
  throw new Error(what);
};

/** Share of the pixels of each canvas of a plot that are drawn. */
const drawn = () =>
  [...document.querySelectorAll(".plot .area")].map((area) => {
    let count = 0;
    for (const canvas of area.querySelectorAll("canvas")) {
      const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
      for (let i = 3; i < pixels.length; i += 4) count += pixels[i] > 100 ? 1 : 0;
    }
    return count;
  });

async function main() {
  const browser = await chromium.launch({
    executablePath: "/usr/bin/chromium",
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
  });
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, offline: true });
  const page = await context.newPage();
  page.setDefaultTimeout(60000); // a busy machine
  const errors = [];
  page.on("console", (m) => m.type() === "error" && errors.push(m.text()));
  page.on("pageerror", (e) => errors.push(String(e)));
  const shot = (name) => page.screenshot({ path: path.join(folder, `${name}.png`) });

  const start = Date.now();
  await page.goto("file://" + path.resolve(file));
  const opened = Date.now() - start;
  await page.waitForFunction(() => document.documentElement.dataset.drawn === "yes");
  console.log(`opened in ${opened} ms, all drawn in ${Date.now() - start} ms`);
  await shot("first");

  if (await page.isHidden("#time")) { // a run without a scan
    if (errors.length) fail(`the console says: ${errors.join("; ")}`);
    return browser.close();
  }

  // every plot has a curve in it
  const counts = await page.evaluate(drawn);
  if (counts.length < 5) fail(`only ${counts.length} plots`);
  counts.forEach((count, i) => count > 200 || fail(`plot ${i} is empty`));

  // axes have their unit
  const units = await page.$$eval(".dygraph-axis-label-x", (all) => all.map((l) => l.textContent));
  if (units.some((text) => !/ (s|m\/s)$/.test(text))) fail(`no unit: ${units.join()}`);

  // the cursor moves the line in all plots, which is as high as they are
  const heights = await page.$$eval(".plot .area", (all) => all.map((area) => {
    const hair = area.querySelector(".hair");
    return hair ? hair.getBoundingClientRect().top - area.getBoundingClientRect().top : 0;
  }));
  if (heights.some((top) => top !== 0)) fail("a line of the cursor is beside its plot");
  const hairs = () => page.$$eval(".plot .hair", (all) => all.map((h) => h.style.left));
  const before = await hairs();
  const now = await page.textContent("#now");
  await page.focus("#cursor");
  await page.$eval("#cursor", (e) => {
    e.value = +e.min + 0.8 * (e.max - e.min);
    e.dispatchEvent(new Event("input"));
  });
  const after = await hairs();
  if (before.some((left, i) => left === after[i])) fail("a plot does not follow the cursor");
  if ((await page.textContent("#now")) === now) fail("the time is not told");

  // zoom in one plot zooms all, and the events
  const labels = () =>
    page.$$eval(".plot .area", (all) => all.map((a) => [...a.querySelectorAll(".dygraph-axis-label-x")].map((l) => l.textContent).join()));
  const wide = await labels();
  const hairCount = after.length;
  const scene = () => page.$eval("#view", (c) => c.toDataURL());
  const all = await scene();
  await page.focus("#play");
  await page.keyboard.press("+");
  await page.waitForTimeout(300);
  const narrow = await labels();
  for (let i = 0; i < hairCount; ++i) if (wide[i] === narrow[i]) fail(`plot ${i} does not zoom`);
  if ((await scene()) === all) fail("the path does not show the time in view");
  await page.click("#whole");
  await page.waitForTimeout(300);
  if ((await labels()).slice(0, hairCount).join() !== wide.slice(0, hairCount).join()) fail("the zoom does not end");
  if (await page.$("#strip button[hidden]")) fail("an event is not in the whole run");

  // arrow keys move the cursor wherever one is, and only there where they do nothing else
  const time = () => page.textContent("#now");
  const still = await time();
  await page.keyboard.press("ArrowRight");
  if ((await time()) === still) fail("an arrow key does not move the cursor");

  // the wheel scrolls the page over the paths, until one has clicked there
  const place = await (await page.$("#view")).boundingBox();
  await page.mouse.move(place.x + 0.75 * place.width, place.y + 0.5 * place.height);
  const far = await page.evaluate(() => scrollY);
  await page.mouse.wheel(0, 100);
  await page.waitForFunction((y) => scrollY > y, far, { timeout: 5000 }).catch(() => fail("the wheel does not scroll"));
  await page.evaluate(() => scrollTo(0, 0));

  // the 3-D view turns
  await page.focus("#view");
  const one = await scene();
  await page.keyboard.press("ArrowLeft");
  await page.waitForTimeout(300);
  const two = await scene();
  if (one === two) fail("the 3-D view does not turn");
  const box = await (await page.$("#view")).boundingBox();
  await page.mouse.move(box.x + 0.75 * box.width, box.y + 0.5 * box.height);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.85 * box.width, box.y + 0.6 * box.height, { steps: 4 });
  await page.mouse.up();
  await page.waitForTimeout(300);
  if ((await scene()) === two) fail("the mouse does not turn the 3-D view");
  await shot("turned");

  // an event moves the cursor
  if (await page.$("#strip button")) {
    const at = await page.textContent("#now");
    await page.click("#events button >> nth=-1");
    if (at === (await page.textContent("#now"))) fail("an event does not move the cursor");
  }

  // on a telephone nothing is wider than the screen
  await page.setViewportSize({ width: 390, height: 844 });
  await page.waitForTimeout(300);
  const widest = await page.evaluate(() => document.documentElement.scrollWidth);
  if (widest > 390) fail(`${widest} pixels wide on a telephone`);
  await shot("telephone");
  await page.setViewportSize({ width: 1280, height: 900 });

  await page.emulateMedia({ colorScheme: "dark" });
  const is_dark = () => getComputedStyle(document.body).backgroundColor !== "rgb(255, 255, 255)";
  await page.waitForFunction(is_dark).catch(() => fail("there is no dark view"));
  await shot("dark");
  await page.emulateMedia({ colorScheme: "light" });
  await page.pdf({ path: path.join(folder, "print.pdf"), format: "A4", printBackground: true });
  await page.screenshot({ path: path.join(folder, "whole.png"), fullPage: true });
  if (errors.length) fail(`the console says: ${errors.join("; ")}`);
  await browser.close();
}

main().catch((error) => {
  console.error(error.message);
  process.exit(1);
});
