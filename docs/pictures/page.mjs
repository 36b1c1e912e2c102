// A picture of crspf view's page at a moment of a recording, in headless Chromium.
// usage: node page.mjs CRSPF RUN.pcapng SECONDS FILE.png WIDTHxHEIGHT ZOOM [--no-scan]
//   ZOOM: so many times as large as at the start; the robot is in the middle. The map alone is shown.
import {spawn} from "node:child_process";
import {Browser, sleep} from "../../tests/checks/browser.mjs";

const [crspf, run, position, file, size, zoom, without] = process.argv.slice(2);
const [width, height] = size.split("x").map(Number);
const PANEL_PX = 354, BAR_PX = 51;  // of the page, beside and above its map, about

const view = spawn(crspf, ["view", run, "--port", "0", "--speed", "10"], {stdio: ["ignore", "pipe", "inherit"]});
let said = "";
view.stdout.on("data", data => { said += data; });
for (let i = 0; i < 600 && !said.includes("foxglove  ws://"); ++i) await sleep(50);

const id = name => `document.getElementById("${name}")`;
let browser;
try {
  browser = await Browser.start();
  await browser.size(width + PANEL_PX, height + BAR_PX, "light");
  await browser.open(said.match(/page +(http:\S+)/)[1]);
  const clock = `${Math.floor(position / 60)}:${String(position % 60).padStart(2, "0")}`;
  await browser.until(`${id("state")}.textContent === "Tracking"`);
  await browser.until(`(([m, s]) => 60 * m + +s)(${id("time")}.textContent.split(" ")[0].split(":")) >= ${position} + 2`, "it is played so far");
  await browser.click("#play");
  await browser.until(`${id("play")}.getAttribute("aria-label") === "Play"`, "it pauses");
  await browser.value(`${id("position")}.value = ${position}; for (const type of ["input", "change"]) ${id("position")}.dispatchEvent(new Event(type))`);
  await browser.until(`${id("time")}.textContent.startsWith("${clock} ") && !${id("state")}.textContent.includes("Seeking")`, "it goes there");
  await browser.value(`for (const name of ["tools", "transport", "hint"]) document.getElementById(name).style.visibility = "hidden"`);
  if (without === "--no-scan") {
    await browser.value(`for (const name of ["scan", "critical", "critical-ray"]) document.documentElement.style.setProperty("--" + name, "transparent"); ${id("legend")}.style.visibility = "hidden"`);
    for (const scheme of ["dark", "light"]) {  // where it changes colours are read anew
      await browser.size(width + PANEL_PX, height + BAR_PX, scheme);
      await sleep(500);
    }
  }
  await browser.value(`for (let i = 0; i < Math.round(Math.log(${zoom}) / Math.log(1.4)); ++i) ${id("zoom-in")}.click()`);
  await sleep(1500);  // what is on its way is drawn
  const {x, y, width: w, height: h} = await browser.value(`${id("map")}.getBoundingClientRect().toJSON()`);
  await browser.screenshot(file, {x, y, width: w, height: h});
} catch (error) {
  console.error(`FAILED: ${file}: ${error.message}`);
  process.exitCode = 1;
} finally {
  view.kill("SIGKILL");
  await browser?.end();
}
