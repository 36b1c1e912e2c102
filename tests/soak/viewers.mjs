// Headless browsers that look at crspf view's page until SIGTERM. Says `seen` when each has the map and its robot. Status 1 if
// a page has lost them by the end, or complains.
// usage: node viewers.mjs URL COUNT
import {Browser, sleep} from "../checks/browser.mjs";

const [url, count] = process.argv.slice(2);
const text = id => `document.getElementById("${id}").textContent`;
const stopped = new Promise(resolve => process.once("SIGTERM", resolve));
const browsers = [];
try {
  for (let i = 0; i < Number(count); ++i) {
    const browser = await Browser.start();
    browsers.push(browser);
    await browser.size(1180, 820, "light");
    await browser.open(url);
    await browser.until(`${text("state")} === "Tracking"`, "a robot that is tracked");
  }
  console.log("seen");
  await stopped;
  for (const browser of browsers) {
    const before = await browser.value(text("x") + "+" + text("y"));
    await sleep(500);
    if (await browser.value(text("state")) !== "Tracking" || await browser.value(text("x") + "+" + text("y")) === before) {
      throw new Error("the robot stands still: " + await browser.value(text("state")));
    }
    if (browser.troubles.length > 0) throw new Error(browser.troubles.join("; "));
  }
} catch (error) {
  console.error("FAILED: " + error.message);
  process.exitCode = 1;
} finally {
  await Promise.all(browsers.map(browser => browser.end()));
}
