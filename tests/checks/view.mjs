// The operator's page from end to end: crspf view on a recording and on a running service, in headless Chromium.
// usage: node view.mjs CRSPF CRSPFD FOLDER: FOLDER holds run.pcapng, and gets screenshots; robot.toml is made in it
import {spawn} from "node:child_process";
import {readFileSync, writeFileSync} from "node:fs";
import {join} from "node:path";
import {Browser, sleep} from "./browser.mjs";

const [crspf, crspfd, folder] = process.argv.slice(2);
const running = new Set();

function start(program, args) {
  const child = spawn(program, args, {stdio: ["ignore", "pipe", "pipe"]});
  running.add(child);
  child.said = "";
  for (const stream of [child.stdout, child.stderr]) stream.on("data", data => { child.said += data; });
  child.gone = new Promise(resolve => child.once("exit", code => { running.delete(child); resolve(code); }));
  return child;
}
async function stop(child, signal = "SIGTERM") {
  child.kill(signal);
  return child.gone;
}
async function startView(...args) {
  const view = start(crspf, ["view", ...args]);
  for (let i = 0; i < 600 && !view.said.includes("foxglove  ws://"); ++i) await sleep(50);
  const url = view.said.match(/page +(http:\S+)/)?.[1];
  if (!url) throw new Error("crspf view does not start: " + view.said);
  return {view, url, port: new URL(url).port};
}
function demand(so, what) { if (!so) throw new Error(what); }

// Pixels of the map's canvas that have about the colour of a variable of the style sheet.
const pixels = name => `(() => {
  const wanted = getComputedStyle(document.documentElement).getPropertyValue("--${name}").match(/[0-9a-f]{2}/gi).map(h => parseInt(h, 16));
  const canvas = document.getElementById("map"), data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (wanted.every((c, k) => Math.abs(c - data[i + k]) < 12)) ++count;
  return count;
})()`;
const text = id => `document.getElementById("${id}").textContent`;
const shown = id => `document.getElementById("${id}").checkVisibility()`;

async function checkReplay(browser) {
  let {view, url, port} = await startView(join(folder, "run.pcapng"), "--port", "0", "--speed", "2");
  await browser.size(1280, 800);
  await browser.open(url);
  await browser.until(`${text("state")} === "Tracking"`);
  demand(await browser.value(shown("transport")), "there is no play button");
  demand(!await browser.value(shown("set-pose")), "a recording's pose can be set");

  await browser.until(`${pixels("free")} > 2000 && ${pixels("taken")} > 100`, "the map appears");
  const before = await browser.value(text("x") + "+" + text("y"));
  await browser.until(`${text("x")}+${text("y")} !== ${JSON.stringify(before)}`, "the robot moves");
  await browser.until(`${pixels("critical")} > 5`, "critical rays are marked");
  await browser.click("#fit");
  await browser.until(`${pixels("path")} > 10`, "there is a path");
  const path = await browser.value(pixels("path"));
  await browser.until(`${pixels("path")} > ${path} + 30`, "the path grows");
  demand(Number(await browser.value(text("M"))) > 500, "M is shown");
  await sleep(3000);  // for the pictures
  await browser.screenshot(join(folder, "replay_desktop.png"));

  await browser.click("#play");
  await browser.until(`document.getElementById("play").getAttribute("aria-label") === "Play"`, "it pauses");
  await sleep(500);
  const paused = await browser.value(text("x") + "+" + text("y") + "+" + text("time"));
  await sleep(1500);
  demand(await browser.value(text("x") + "+" + text("y") + "+" + text("time")) === paused, "it moves while it is paused");
  await browser.value(`(() => { const p = document.getElementById("position"); p.value = 4; p.dispatchEvent(new Event("input")); p.dispatchEvent(new Event("change")); })()`);
  await browser.until(`${text("time")}.startsWith("0:04")`, "it goes back to another position");
  await browser.value(`(() => { const s = document.getElementById("speed"); s.value = "10"; s.dispatchEvent(new Event("change")); })()`);
  await browser.click("#play");
  await browser.until(`Number(${text("time")}.slice(2, 4)) > 6`, "it goes on");

  await browser.click("#measure");
  await browser.drag([300, 400], [500, 400]);
  demand(/\d\.\d\d m /.test(await browser.value(text("hint"))), "a distance is measured");
  await browser.click("#measure");

  await stop(view, "SIGKILL");
  await browser.until(`${shown("banner")} && ${text("state")} === "Not connected"`, "the loss is told");
  await browser.screenshot(join(folder, "lost_desktop.png"));
  ({view} = await startView(join(folder, "run.pcapng"), "--port", port, "--speed", "10"));
  await browser.until(`${text("state")} === "Tracking" && !${shown("banner")}`, "it comes back by itself");
  await browser.click("#follow");
  await sleep(4000);
  for (const [name, width, height, scheme] of [["upright", 820, 1180, "light"], ["lying", 1180, 820, "light"], ["phone", 412, 915, "dark"]]) {
    await browser.size(width, height, scheme);
    await sleep(700);
    demand(await browser.value("document.documentElement.scrollWidth <= innerWidth && document.documentElement.scrollHeight <= innerHeight"), `${name}: wider or higher than the window`);
    demand(await browser.value(`[...document.querySelectorAll("#stage button")].filter(b => b.checkVisibility()).every(b => b.offsetWidth >= 44 && b.offsetHeight >= 44)`), `${name}: a button is too small for a finger`);
    await browser.screenshot(join(folder, `replay_${name}.png`));
  }
  demand(await stop(view) === 0, "it does not end well: " + view.said);
}

// From the navigation to the first map that is drawn, and to buttons that react, with nothing cached. Told, not judged.
async function timePage(browser) {
  const {view, url} = await startView(join(folder, "run.pcapng"), "--port", "0", "--speed", "10");
  await browser.size(1280, 800);
  await browser.open(url);
  await browser.until(`Number(${text("time")}.slice(2, 4)) > 20`, "there is a map to be shown");
  await browser.click("#play");
  await browser.ask("Network.setCacheDisabled", {cacheDisabled: true});
  // At each frame a look, and a press until it is heeded; no earlier than that the page has a map's canvas of its own.
  const source = `(() => {
    const seen = window.seen = {looks: 0, button: 0, map: 0};
    const look = () => {
      ++seen.looks;
      const button = document.getElementById("measure");
      if (!seen.button) {
        button?.click();
        if (button?.getAttribute("aria-pressed") === "true") seen.button = performance.now();
      } else if (${pixels("free")} > 2000) {
        seen.map = performance.now();
        return;
      }
      requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  })()`;
  const {identifier} = await browser.ask("Page.addScriptToEvaluateOnNewDocument", {source});
  const times = {map: [], button: []};
  for (let i = 0; i < 5; ++i) {
    await browser.open("about:blank");
    await browser.open(url);
    await browser.until("window.seen?.map > 0", "the map is drawn");
    const seen = await browser.value("window.seen");
    demand(seen.looks > 2, "the map was there before the page");
    for (const what of ["map", "button"]) times[what].push(seen[what]);
  }
  await browser.ask("Page.removeScriptToEvaluateOnNewDocument", {identifier});
  await browser.ask("Network.setCacheDisabled", {cacheDisabled: false});
  const tell = ms => `${ms.sort((a, b) => a - b)[2].toFixed(0)} ms (${ms[0].toFixed(0)} to ${ms[4].toFixed(0)})`;
  console.log(`page, from the navigation, median of 5: buttons react after ${tell(times.button)}, the map is drawn after ${tell(times.map)}`);
  demand(await stop(view) === 0, "it does not end well: " + view.said);
}

function writeConfig() {
  const config = readFileSync(new URL("no_sensors.toml", import.meta.url), "utf8");
  writeFileSync(join(folder, "robot.toml"), config.replaceAll("FOLDER", folder));
}

// A service without sensors: what it says, what it is told, its end and its return.
async function checkLive(browser) {
  writeConfig();
  const startService = () => start(crspfd, ["--config", join(folder, "robot.toml"), "--allow-degraded"]);
  const {view, url} = await startView("--socket", join(folder, "control"), "--control", "--port", "0", "--token-file", join(folder, "token"));
  await browser.size(1280, 800);
  await browser.open(url.replace(/\?.*/, ""));
  await browser.until(`document.getElementById("token-dialog").open`, "a token is asked for");
  await browser.open(url);
  await browser.until(`${shown("banner")} && ${text("state")} === "Service away"`, "the service is missed");
  demand(!await browser.value("location.search"), "the token stays in the address bar");
  let service = startService();
  await browser.until(`!${text("state")}.includes("away") && ${shown("sensors")}`, "the service is there");
  await browser.until(`${text("sensors")}.includes("no_such_tty")`, "the sensor says what is wrong");
  await browser.until(`document.querySelectorAll("#threads tbody tr").length >= 5`, "latencies are shown");
  await browser.until(`document.querySelector("#threads .count") !== null`, "latencies are counted");

  // The control of what is looked for in the other's map: here there is none of it, but for the edges of letters.
  for (const colour of ["free", "path", "critical"]) demand(await browser.value(pixels(colour)) < 100, `there is ${colour} where nothing was seen`);

  await browser.click("#set-pose");
  await browser.drag([400, 400], [500, 400]);
  await browser.until(shown("confirm"), "the pose is to be confirmed");
  await browser.screenshot(join(folder, "live_set_pose.png"));
  await browser.click("#confirm-yes");
  await browser.until(`${text("hint")} === "Done"`, "the pose is set");

  await stop(service, "SIGKILL");
  await browser.until(`${text("state")} === "Service away"`, "the end of the service is told");
  await browser.screenshot(join(folder, "live_away.png"));
  service = startService();
  await browser.until(`${text("state")} !== "Service away" && !${text("banner-text")}.includes("away")`, "the service is back");
  await stop(service);
  demand(await stop(view) === 0, "it does not end well: " + view.said);
}

let browser;
try {
  browser = await Browser.start();
  await checkReplay(browser);
  console.log("recording: right");
  await timePage(browser);
  await checkLive(browser);
  console.log("service: right");
  const foreign = browser.fetched.filter(each => !/^(http|ws):\/\/127\.0\.0\.1[:/]/.test(each) && !each.startsWith("data:"));
  demand(foreign.length === 0, "fetched from elsewhere: " + foreign);
  const troubles = browser.troubles.filter(each => !/WebSocket connection|ERR_CONNECTION|401/.test(each));  // of those planted above
  demand(troubles.length === 0, "the page complains: " + troubles.join("; "));
} catch (error) {
  console.error("FAILED: " + error.message);
  if (browser) await browser.screenshot(join(folder, "failed.png")).catch(() => {});
  process.exitCode = 1;
} finally {
  for (const child of running) child.kill("SIGKILL");
  await browser?.end();
}
