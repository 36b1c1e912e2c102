// npm's mqtt as a subscriber to crspf mqtt: what is kept comes at once, poses come, a tile inflates.
// usage: node mqtt.mjs URL TOPIC; mqtt is in NODE_PATH
import {createRequire} from "node:module";
import {inflateSync} from "node:zlib";

const require = createRequire(process.env.NODE_PATH + "/x.js");
const mqtt = require("mqtt");
const [url, topic] = process.argv.slice(2);

function demand(so, what) { if (!so) throw new Error(what); }
// What each message has to be; throws where it is not.
const judges = {
  online(online, kept) { demand(online === true && kept, "online: is kept, and true"); },
  health(health) { demand(typeof health.state === "string" && Array.isArray(health.sensors), "health: state and sensors"); },
  pose(pose, kept) { demand(Number.isFinite(pose.x_m + pose.y_m + pose.heading_deg) && !kept, "pose: numbers, and not kept"); },
  map(map) { demand(Number.isSafeInteger(map.map_id) && map.resolution_m > 0, "map: id and resolution"); },
  tile(tile) { demand(inflateSync(Buffer.from(tile.cells, "base64")).length === tile.side_cells ** 2, "tile: its cells"); },
};

const seen = new Set(), client = mqtt.connect(url, {reconnectPeriod: 0});
const patience = setTimeout(() => fail(new Error("not in time; seen: " + [...seen])), 30000);
function fail(error) {
  console.error("FAILED: " + error.message);
  process.exit(1);
}
client.on("error", fail);
client.on("connect", () => client.subscribe(topic + "/#"));
client.on("message", (name, payload, packet) => {
  const leaf = name.slice(topic.length + 1), kind = leaf.startsWith("map/") ? "tile" : leaf;
  if (payload.length === 0 || !(kind in judges)) return;  // a tile that is gone, or a line of the log
  try {
    judges[kind](JSON.parse(payload), packet.retain);
  } catch (error) { fail(error); }
  seen.add(kind);
  if (seen.size < Object.keys(judges).length) return;
  clearTimeout(patience);
  client.end();
  console.log("npm's mqtt: right");
});
