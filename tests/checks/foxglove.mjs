// npm's client of the Foxglove WebSocket protocol on crspf view: subscribes, decodes, calls.
// usage: node foxglove.mjs URL; @foxglove/ws-protocol and ws are in NODE_PATH
import {createRequire} from "node:module";

const require = createRequire(process.env.NODE_PATH + "/x.js");
const {FoxgloveClient} = require("@foxglove/ws-protocol");
const {WebSocket} = require("ws");

function demand(so, what) { if (!so) throw new Error(what); }
const isTime = t => Number.isInteger(t.sec) && t.nsec >= 0 && t.nsec < 1e9;
const decoder = new TextDecoder();

// What each message has to be; throws where it is not.
const judges = {
  "foxglove.PoseInFrame"(pose) {
    demand(isTime(pose.timestamp) && pose.frame_id === "map", "pose: time or frame");
    const {x, y, z, w} = pose.pose.orientation;
    demand(Math.abs(Math.hypot(x, y, z, w) - 1) < 1e-6 && Number.isFinite(pose.pose.position.x), "pose: no rotation");
  },
  "foxglove.PointCloud"(cloud) {
    const bytes = Buffer.from(cloud.data, "base64"), at = Object.fromEntries(cloud.fields.map(f => [f.name, f.offset]));
    demand(bytes.length > 0 && bytes.length % cloud.point_stride === 0, "scan: no whole points");
    for (let i = 0; i < bytes.length; i += cloud.point_stride) {
      demand(Math.hypot(bytes.readFloatLE(i + at.x), bytes.readFloatLE(i + at.y)) < 100, "scan: a point is far");
      demand(bytes[i + at.critical] <= 1, "scan: critical is 0 or 1");
    }
  },
  "foxglove.Grid"(grid) {
    const cells = Buffer.from(grid.data, "base64"), counts = {unseen: 0, free: 0, taken: 0};
    demand(cells.length % grid.row_stride === 0 && grid.column_count === grid.row_stride && grid.cell_size.x > 0, "map: its sizes");
    for (const cell of cells) ++counts[cell === 255 ? "unseen" : cell > 60 ? "taken" : "free"];
    return counts.free > 100 && counts.taken > 10;  // the first pictures have next to nothing
  },
};

const client = new FoxgloveClient({ws: new WebSocket(process.argv[2], [FoxgloveClient.SUPPORTED_SUBPROTOCOL])});
const wanted = new Set(["/pose", "/scan", "/map"]);
const channels = new Map();
const seen = new Map();

const done = new Promise((resolve, reject) => {
  const patience = setTimeout(() => reject(new Error("not in time; seen: " + [...seen.keys()])), 60000);
  client.on("error", reject);
  client.on("status", status => reject(new Error("told: " + status.message)));
  client.on("close", () => reject(new Error("closed")));
  client.on("advertise", list => {
    for (const channel of list) {
      demand(channel.encoding === "json" && JSON.parse(channel.schema).type === "object", channel.topic + ": no JSON schema");
      if (wanted.has(channel.topic)) channels.set(client.subscribe(channel.id), channel);
    }
    demand(channels.size === wanted.size, "not all topics are there");
  });
  client.on("message", ({subscriptionId, timestamp, data}) => {
    try {
      const channel = channels.get(subscriptionId), message = JSON.parse(decoder.decode(data));
      const enough = judges[channel.schemaName](message) ?? true;
      demand(timestamp === BigInt(message.timestamp.sec) * 1000000000n + BigInt(message.timestamp.nsec), "the stamps differ");
      if (enough) seen.set(channel.topic, (seen.get(channel.topic) ?? 0) + 1);
    } catch (error) { reject(error); }
    if (seen.size === wanted.size && seen.get("/pose") > 5) { clearTimeout(patience); resolve(); }
  });
});

const called = new Promise((resolve, reject) => {
  const answers = [];
  client.on("advertiseServices", services => {
    const id = services.find(service => service.name === "/playback").id;
    const ask = (callId, request) => client.sendServiceCallRequest({serviceId: id, callId, encoding: "json", data: new TextEncoder().encode(JSON.stringify(request))});
    ask(1, {speed: 2});
    ask(2, {speed: -1});
  });
  client.on("serviceCallFailure", failure => reject(new Error(failure.message)));
  client.on("serviceCallResponse", ({callId, encoding, data}) => {
    answers[callId] = JSON.parse(decoder.decode(data));
    if (!answers[1] || !answers[2]) return;
    const right = encoding === "json" && answers[1].ok === true && answers[2].ok === false && answers[2].error.includes("speed");
    if (right) resolve(); else reject(new Error("the service's answers: " + JSON.stringify(answers)));
  });
});

try {
  await Promise.all([done, called]);
  console.log("right:", Object.fromEntries(seen));
} catch (error) {
  console.error("FAILED: " + error.message);
  process.exitCode = 1;
}
process.exit();
