// The operator's page: brings connection, map, charts and panel together.
import {LineChart, MatchChart, History} from "./charts.js";
import {Client} from "./foxglove.js";
import {MapView} from "./map_view.js";
import {Panel, clock, degrees, wrapped} from "./panel.js";
import {Tiles, bytesOf} from "./tiles.js";

const $ = id => document.getElementById(id);
const SILENT_MS = 3000;  // a status comes twice a second
const SCANS_MS = 1500;
const POSES_KEPT = 32;

const tiles = new Tiles();
const map = new MapView($("map"), tiles);
const history = new History();
const panel = new Panel();
const charts = [
  new MatchChart($("match-chart"), history),
  new LineChart($("evaluations-chart"), history, "evaluations", s => s.evaluations, v => v.toFixed(0)),
  new LineChart($("range-chart"), history, "half width", s => s.range_m, v => (100 * v).toFixed(0) + " cm"),
];
const client = new Client(["/match", "/scan", "/path", "/map/tiles", "/status", "/log"]);

// --- what comes

const state = {connected: false, away: false, why: "", scanLost: false, serviceLost: false, degenerate: false, matched: false, everConnected: false, replay: null, heardMs: 0, scanMs: 0, retryAtMs: 0};
const poses = new Map();  // of the last scans, by stamp

const seconds = ({sec, nsec}) => sec + 1e-9 * nsec;
const stampKey = ({sec, nsec}) => sec + "." + nsec;

const takers = {
  "/match"(scan) {
    const t = seconds(scan.timestamp);
    history.add({t, M: scan.M, m: scan.m, matched: scan.matched, result: scan.result, draw: scan.draw,
                 evaluations: scan.evaluations, range_m: scan.range_m, thresholds: scan.thresholds});
    poses.set(stampKey(scan.timestamp), scan);
    if (poses.size > POSES_KEPT) poses.delete(poses.keys().next().value);
    showScanWithPose();
    Object.assign(state, {scanLost: scan.lost, degenerate: scan.degenerate, matched: scan.matched, scanMs: Date.now()});
    map.robot = scan;
    map.lost = isLost();
    map.changed();
    latest.scan = scan;
    latest.t = t;
    later();
  },
  "/scan"(cloud) {
    scanWithoutPose = {key: stampKey(cloud.timestamp), points: pointsOf(cloud)};
    showScanWithPose();
  },
  "/path"(path) {
    map.path = path.poses.flatMap(({position}) => [position.x, position.y]);
    map.changed();
  },
  "/map/tiles"(message) {
    tiles.take(message);
    map.changed();
  },
  "/status"(status) {
    if ("away" in status) {
      Object.assign(state, {away: status.away, why: status.why ?? ""});
    } else {
      state.away = false;
      state.serviceLost = status.pose?.lost ?? false;  // without scans /match has no word of it
      panel.showStatus(status);
      showReplay(status.replay);
    }
    showState();
  },
  "/log"(line) { panel.showLine(line); },
};

// A scan is drawn where it was taken; which of the two messages comes first is not said.
let scanWithoutPose = null;
function showScanWithPose() {
  const pose = scanWithoutPose && poses.get(scanWithoutPose.key);
  if (!pose) return;
  map.scan = {pose, points: scanWithoutPose.points};
  scanWithoutPose = null;
  map.changed();
}

// foxglove.PointCloud: x, y and whether the ray is critical.
function pointsOf(cloud) {
  const bytes = bytesOf(cloud.data), view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const offset = name => cloud.fields.find(field => field.name === name).offset;
  const [x, y, critical] = [offset("x"), offset("y"), offset("critical")];
  const count = Math.floor(bytes.length / cloud.point_stride), points = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const at = i * cloud.point_stride;
    points[3 * i] = view.getFloat32(at + x, true);
    points[3 * i + 1] = view.getFloat32(at + y, true);
    points[3 * i + 2] = view.getUint8(at + critical);
  }
  return points;
}

// Numbers and curves change with the screen at most.
const latest = {scan: null, t: 0, pending: false};
function later() {
  if (latest.pending) return;
  latest.pending = true;
  requestAnimationFrame(() => {
    latest.pending = false;
    panel.showScan(latest.scan, latest.t);
    for (const chart of charts) chart.changed();
    showState();
  });
}

// --- how it is

function isLost() { return state.scanLost || state.serviceLost && !state.replay; }

function stateNow() {
  if (!state.connected) return ["bad", "Not connected"];
  if (state.away) return ["bad", "Service away"];
  if (!map.robot) return isLost() ? ["bad", "LOST"] : ["", "Waiting for a scan"];
  if (state.replay?.seeking) return ["", "Seeking"];
  if (isLost()) return ["bad", "LOST"];
  if (!state.replay && Date.now() - state.scanMs > SCANS_MS) return ["bad", "No scans"];
  if (state.degenerate) return ["warn", "One direction unseen"];
  return state.matched ? ["good", "Tracking"] : ["warn", "Odometry only"];
}

function bannerNow() {
  const wait = Math.max(0, Math.ceil((state.retryAtMs - Date.now()) / 1000));
  if (!state.connected) return [`The connection to crspf view is lost; trying again${wait > 0 ? ` in ${wait} s` : ""}.`, "Try now", () => client.connect()];
  if (state.away) return [`The service is away: ${state.why}`, "", null];
  if (state.heardMs > 0 && Date.now() - state.heardMs > SILENT_MS) return ["Nothing has come for some seconds: what is shown is old.", "", null];
  if (isLost() && !state.replay?.seeking) {
    return ["The robot is lost: its pose is not to be steered by.", client.services.has("/relocalize") ? "Look for it" : "", () => $("relocalize").click()];
  }
  return ["", "", null];
}

function showState() {
  const [kind, text] = stateNow();
  if ($("state").textContent !== text) $("state").textContent = text;
  $("state").className = "chip " + kind;
  const [banner, button, action] = bannerNow();
  $("banner").hidden = banner === "" || !state.everConnected;
  if ($("banner-text").textContent !== banner) $("banner-text").textContent = banner;
  $("banner-button").hidden = button === "";
  $("banner-button").textContent = button;
  $("banner-button").onclick = action;
  document.body.classList.toggle("stale", !state.connected || state.away);
}
setInterval(showState, 500);

client.addEventListener("open", () => {
  Object.assign(state, {connected: true, everConnected: true, heardMs: Date.now()});
  poses.clear();
  history.samples = [];
  $("log").replaceChildren();
  showState();
});
client.addEventListener("close", ({detail: waitMs}) => {
  Object.assign(state, {connected: false, everConnected: true, retryAtMs: Date.now() + waitMs});
  showServices([]);
  showState();
});
client.addEventListener("message", ({detail: {topic, data}}) => {
  state.heardMs = Date.now();
  takers[topic]?.(data);
});

// --- token: in the URL once, then only in this tab

client.addEventListener("unauthorized", () => {
  state.connected = false;
  sessionStorage.removeItem("token");
  showState();
  if (!$("token-dialog").open) $("token-dialog").showModal();
});
$("token-form").addEventListener("submit", () => {
  sessionStorage.setItem("token", client.token = $("token").value.trim());
  $("token").value = "";
  client.connect();
});
function findToken() {
  const url = new URL(location.href), given = url.searchParams.get("token");
  if (given) {
    sessionStorage.setItem("token", given);
    url.searchParams.delete("token");
    window.history.replaceState(null, "", url);
  }
  return sessionStorage.getItem("token") ?? "";
}

// --- map tools

function press(id, on) { $(id).setAttribute("aria-pressed", String(on)); }

function setTool(tool) {
  map.setTool(map.tool === tool ? "move" : tool);
  press("measure", map.tool === "measure");
  press("set-pose", map.tool === "pose");
  $("confirm").hidden = true;
  hint({measure: "Drag from one place to another", pose: "Press where the robot is, and drag to where it looks"}[map.tool] ?? "");
}

function hint(text, forMs = 0) {
  $("hint").hidden = text === "";
  $("hint").textContent = text;
  clearTimeout(hint.timer);
  if (forMs > 0) hint.timer = setTimeout(() => hint(""), forMs);
}

$("follow").onclick = () => map.setFollow(!map.follow);
$("fit").onclick = () => map.fit();
$("zoom-in").onclick = () => map.zoom(1.4);
$("zoom-out").onclick = () => map.zoom(1 / 1.4);
$("measure").onclick = () => setTool("measure");
$("set-pose").onclick = () => setTool("pose");
map.addEventListener("follow", ({detail: on}) => press("follow", on));
map.addEventListener("measured", ({detail: text}) => { if (text) hint(text); });

addEventListener("keydown", event => {
  if (event.target.matches("input, select, textarea") || event.ctrlKey || event.altKey || event.metaKey || $("token-dialog").open) return;
  const step = 60 * map.dpr;
  const keys = {
    f: () => $("follow").click(), m: () => $("measure").click(), 0: () => map.fit(), "+": () => map.zoom(1.4), "=": () => map.zoom(1.4), "-": () => map.zoom(1 / 1.4),
    p: () => { if (!$("set-pose").hidden) $("set-pose").click(); },
    Escape: () => { if (!$("confirm").hidden || map.tool !== "move") cancel(); },
    " ": () => { if (!$("transport").hidden && event.target === $("map")) $("play").click(); },
    ArrowLeft: () => map.pan(step, 0), ArrowRight: () => map.pan(-step, 0), ArrowUp: () => map.pan(0, step), ArrowDown: () => map.pan(0, -step),
  };
  if (event.key.startsWith("Arrow") && event.target !== $("map") && event.target !== document.body) return;
  if (keys[event.key]) { keys[event.key](); if (event.key.startsWith("Arrow") || event.key === " " && event.target === $("map")) event.preventDefault(); }
});

// --- actions: asked for, confirmed, then done

let action = null;  // {name, request}
function confirmAction(text, yes, name, request) {
  action = {name, request};
  $("confirm-text").textContent = text;
  $("confirm-yes").textContent = yes;
  $("confirm").hidden = false;
  hint("");
}
function cancel() {
  $("confirm").hidden = true;
  if (map.tool !== "move") setTool(map.tool);
}
$("confirm-no").onclick = cancel;
$("confirm").addEventListener("submit", async event => {
  event.preventDefault();
  const {name, request} = action;
  cancel();
  hint("Asking …");
  const answer = await client.call(name, request).catch(error => ({ok: false, error: error.message}));
  hint(answer.ok ? {"/relocalize": "Looking for the robot; the log tells what comes of it"}[name] ?? "Done" : "Not done: " + answer.error, answer.ok ? 4000 : 12000);
});
map.addEventListener("placed", ({detail: pose}) => {
  const heading_deg = degrees(wrapped(pose.heading_rad));
  confirmAction(`The robot is at x ${pose.x_m.toFixed(2)} m, y ${pose.y_m.toFixed(2)} m, heading ${heading_deg.toFixed(0)}°`, "Set pose",
                "/set_pose", {x_m: pose.x_m, y_m: pose.y_m, heading_deg});
});
$("relocalize").onclick = () => {
  if (map.tool !== "move") setTool(map.tool);
  confirmAction("Look for the robot in the whole map? Where it is found elsewhere, its pose jumps.", "Look for it", "/relocalize", {});
};

function showServices(names) {
  $("set-pose").hidden = !names.includes("/set_pose");
  $("relocalize").hidden = !names.includes("/relocalize");
  $("transport").hidden = !names.includes("/playback");
  if (!names.includes("/set_pose") && map.tool === "pose") setTool("pose");
  document.body.classList.toggle("replay", names.includes("/playback"));
  $("mode").textContent = names.includes("/playback") ? "replay" : "view";
  layout();
}
client.addEventListener("services", ({detail: names}) => showServices(names));

// --- a recording

const PLAY = "M8 5v14l11-7z", PAUSE = "M7 5h4v14H7zM13 5h4v14h-4z";
let dragging = false;

function showReplay(replay) {
  state.replay = replay ?? null;
  if (!replay) return;
  const stopped = replay.paused || replay.ended;
  $("play-icon").setAttribute("d", stopped ? PLAY : PAUSE);
  $("play").setAttribute("aria-label", stopped ? "Play" : "Pause");
  const duration = Math.max(replay.duration_s ?? 0, replay.position_s, 0.1);
  $("position").max = duration.toFixed(1);
  if (!dragging) $("position").value = replay.position_s;
  $("time").textContent = `${clock(dragging ? Number($("position").value) : replay.position_s)} / ${replay.duration_known ? "" : "≈ "}${clock(duration)}`;
  const speed = [...$("speed").options].find(option => Number(option.value) === replay.speed);
  if (speed && document.activeElement !== $("speed")) $("speed").value = speed.value;
}

async function playback(request) {
  const answer = await client.call("/playback", request).catch(error => ({ok: false, error: error.message}));
  if (!answer.ok) hint("Not done: " + answer.error, 8000);
}
$("play").onclick = () => playback({paused: !(state.replay?.paused || state.replay?.ended)});
$("speed").onchange = () => playback({speed: Number($("speed").value)});
$("position").oninput = () => { dragging = true; $("time").textContent = clock(Number($("position").value)); };
$("position").onchange = () => { dragging = false; playback({position_s: Number($("position").value)}); };

// --- colours and places

function readColours() {
  const style = getComputedStyle(document.documentElement), colour = name => style.getPropertyValue("--" + name).trim();
  const rgb = name => colour(name).match(/[0-9a-f]{2}/gi).map(hex => parseInt(hex, 16));
  map.colours = {unseen: colour("unseen"), grid: colour("grid"), robot: colour("robot"), bad: colour("bad"), path: colour("path"), scan: colour("scan"),
                 critical: colour("critical"), criticalRay: colour("critical-ray"), outline: colour("outline"), text: colour("text"), tool: colour("tool")};
  for (const chart of charts) {
    chart.colours = {plot: colour("plot"), M: colour("robot"), m: colour("faint"), result: colour("good"), draw: colour("draw"), label: colour("dim")};
    chart.changed();
  }
  tiles.setColours(rgb("free"), rgb("taken"));
  map.changed();
}
function layout() {
  map.bottomPx = $("transport").hidden ? 16 : $("transport").offsetHeight + 28;
  map.changed();
}
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", readColours);
addEventListener("resize", layout);

readColours();
client.token = findToken();
client.connect();
