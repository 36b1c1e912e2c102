// A headless Chromium, driven by its DevTools protocol through a pipe: no package of npm is needed.
import {spawn} from "node:child_process";
import {mkdtempSync, rmSync, writeFileSync} from "node:fs";
import {tmpdir} from "node:os";
import {join} from "node:path";

export const sleep = ms => new Promise(resolve => setTimeout(resolve, ms));

export class Browser {
  static async start() {
    const browser = new Browser();
    browser.profile = mkdtempSync(join(tmpdir(), "crspf_view_"));
    browser.process = spawn("chromium", [
      "--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update",
      "--disable-sync", "--disable-dev-shm-usage", "--disable-quic", "--hide-scrollbars", "--remote-debugging-pipe", `--user-data-dir=${browser.profile}`,
      "about:blank"], {stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"]});
    let text = "";
    browser.process.stdio[4].on("data", data => {
      text += data;
      for (let end; (end = text.indexOf("\0")) >= 0; text = text.slice(end + 1)) browser.take(JSON.parse(text.slice(0, end)));
    });
    browser.waiting = new Map();
    browser.next = 1;
    browser.troubles = [];  // what the page or its policy has complained about
    browser.fetched = [];   // URLs
    const {targetInfos} = await browser.ask("Target.getTargets");
    const {targetId} = targetInfos.find(target => target.type === "page");
    browser.session = (await browser.ask("Target.attachToTarget", {targetId, flatten: true})).sessionId;
    for (const domain of ["Page", "Runtime", "Log", "Network"]) await browser.ask(domain + ".enable");
    return browser;
  }

  take(message) {
    const {method, params} = message;
    if (message.id) {
      const {resolve, reject} = this.waiting.get(message.id);
      this.waiting.delete(message.id);
      if (message.error) reject(new Error(message.error.message)); else resolve(message.result);
    } else if (method === "Runtime.exceptionThrown") {
      this.troubles.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    } else if (method === "Log.entryAdded" && params.entry.level === "error") {
      this.troubles.push(`${params.entry.text} ${params.entry.url ?? ""}`);
    } else if (method === "Network.requestWillBeSent") {
      this.fetched.push(params.request.url);
    }
  }

  ask(method, params = {}) {
    const id = this.next++;
    this.process.stdio[3].write(JSON.stringify({id, method, params, sessionId: this.session}) + "\0");
    return new Promise((resolve, reject) => this.waiting.set(id, {resolve, reject}));
  }

  async open(url) { await this.ask("Page.navigate", {url}); }

  async size(width, height, scheme = "dark", scale = 1) {
    await this.ask("Emulation.setDeviceMetricsOverride", {width, height, deviceScaleFactor: scale, mobile: false});
    await this.ask("Emulation.setEmulatedMedia", {features: [{name: "prefers-color-scheme", value: scheme}]});
  }

  // The value of an expression in the page.
  async value(expression) {
    const {result, exceptionDetails} = await this.ask("Runtime.evaluate", {expression, returnByValue: true, awaitPromise: true});
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  // Waits until an expression is true in the page.
  async until(expression, what = expression) {
    for (let i = 0; i < 600; ++i) {
      if (await this.value(expression).catch(() => false)) return;
      await sleep(100);
    }
    const state = await this.value("document.getElementById('state')?.textContent + ' | ' + document.getElementById('banner-text')?.textContent").catch(() => "");
    throw new Error(`it does not come about: ${what} (${state})`);
  }

  async click(selector) { await this.value(`document.querySelector(${JSON.stringify(selector)}).click()`); }

  // With the mouse, as a hand does it; [x, y] in CSS pixels of the page.
  async drag([x0, y0], [x1, y1]) {
    const mouse = (type, x, y, buttons) => this.ask("Input.dispatchMouseEvent", {type, x, y, button: "left", buttons, clickCount: 1});
    await mouse("mousePressed", x0, y0, 1);
    for (let i = 1; i <= 5; ++i) await mouse("mouseMoved", x0 + (x1 - x0) * i / 5, y0 + (y1 - y0) * i / 5, 1);
    await mouse("mouseReleased", x1, y1, 0);
  }

  // clip: {x, y, width, height} in CSS pixels of the page; without it the window.
  async screenshot(file, clip) {
    const {data} = await this.ask("Page.captureScreenshot", {format: "png", ...clip && {clip: {...clip, scale: 1}}});
    writeFileSync(file, Buffer.from(data, "base64"));
  }

  async end() {
    const gone = new Promise(resolve => this.process.once("exit", resolve));
    this.process.kill("SIGKILL");
    await gone;
    await sleep(200);  // its children
    rmSync(this.profile, {recursive: true, force: true, maxRetries: 10, retryDelay: 200});
  }
}
