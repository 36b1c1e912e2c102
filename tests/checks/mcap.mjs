// node mcap.mjs FILE.mcap TRAJECTORY.tum [--bytes]
//
// Reads the export with @mcap/core and decompresses it by libzstd's own program: all checksums, what is on the channels, that
// stamps never run back, and that the poses are those of the trajectory. --bytes: only as far as whole and undamaged.
import {execFileSync} from "node:child_process";
import {readFileSync} from "node:fs";
import {createRequire} from "node:module";

const require = createRequire(process.env.NODE_PATH + "/");
const {McapIndexedReader, McapStreamReader} = require("@mcap/core");

const [file, trajectory, only] = process.argv.slice(2);
const bytes = readFileSync(file);
const decompressHandlers = {
  zstd: (packed, size) => {
    const out = execFileSync("zstd", ["-dcq"], {input: packed, maxBuffer: 1 << 30});
    if (out.length !== Number(size)) throw new Error(`a chunk of ${out.length} bytes, ${size} were promised`);
    return out;
  },
};

function demand(holds, what) {
  if (!holds) throw new Error(what);
}

// From front to back, as from a pipe: the chunks' checksums and that of the data.
const stream = new McapStreamReader({decompressHandlers, validateCrcs: true});
stream.append(bytes);
let streamed = 0, ended = false;
for (let record; (record = stream.nextRecord());) {
  if (record.type === "Message") ++streamed;
  if (record.type === "DataEnd") ended = record.dataSectionCrc !== 0;
}
demand(stream.done() && ended, "the file has no end, or no checksum over its data");

// By the index: the summary's checksum.
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))),
};
const reader = await McapIndexedReader.Initialize({readable, decompressHandlers});
const text = new TextDecoder("utf-8", {fatal: true});
const topics = new Map();
let lastTime = 0n, indexed = 0, first;  // first: stamp of the first scan
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  demand(channel.messageEncoding === "json" && schema.encoding === "jsonschema", `${channel.topic}: not JSON`);
  demand(message.logTime >= lastTime, `${channel.topic}: time runs back`);
  lastTime = message.logTime;
  ++indexed;
  const type = JSON.parse(text.decode(schema.data)), data = JSON.parse(text.decode(message.data));
  for (const name of type.required) demand(name in data, `${channel.topic}: no ${name}`);
  demand(message.publishTime === message.logTime, `${channel.topic}: stamp and time differ`);
  if (channel.topic === "/scan") first ??= message.logTime;
  if (!topics.has(channel.topic)) topics.set(channel.topic, {schema: schema.name, messages: []});
  topics.get(channel.topic).messages.push(data);
}
const all = reader.statistics;
demand(Number(all.messageCount) === indexed && indexed === streamed, `${all.messageCount}, ${indexed} and ${streamed} messages`);
if (only === "--bytes") process.exit(0);

demand(all.messageStartTime === first, `the file begins at ${all.messageStartTime}, its first scan is of ${first}`);

const schemas = {
  "/tf": "foxglove.FrameTransforms", "/pose": "foxglove.PoseInFrame", "/path": "foxglove.PosesInFrame", "/scan": "foxglove.PointCloud",
  "/map": "foxglove.Grid", "/map/tiles": "crspf.MapTiles", "/match": "crspf.ScanResult", "/status": "crspf.Status",
  "/diagnostics": "diagnostic_msgs/DiagnosticArray",
};
for (const [topic, schema] of Object.entries(schemas)) {
  demand(topics.get(topic)?.schema === schema, `${topic} is ${topics.get(topic)?.schema}`);
}
const of = topic => topics.get(topic).messages;
const seconds = time => time.sec + 1e-9 * time.nsec;

const poses = readFileSync(trajectory, "utf8").trim().split("\n").map(line => line.split(" ").map(Number));
demand(poses.length > 50, `only ${poses.length} poses`);
for (const topic of ["/tf", "/pose", "/scan", "/match"]) {
  demand(of(topic).length === poses.length, `${topic}: ${of(topic).length} messages of ${poses.length} scans`);
}
let farthest = 0, latest = 0;
of("/pose").forEach(({timestamp, pose: {position: p, orientation: q}}, i) => {
  const [stamp, x, y, , , , qz, qw] = poses[i];
  latest = Math.max(latest, Math.abs(seconds(timestamp) - stamp));
  farthest = Math.max(farthest, ...[p.x - x, p.y - y, q.z - qz, q.w - qw].map(Math.abs));
});
demand(farthest < 2e-9 && latest < 2e-6, `poses differ by ${farthest}, stamps by ${latest} s`);

// Points, and which of them are critical.
of("/scan").forEach((cloud, i) => {
  const data = Buffer.from(cloud.data, "base64"), match = of("/match")[i];
  demand(data.length === cloud.point_stride * match.rays, "/scan: not as many points as rays");
  const at = cloud.fields.find(field => field.name === "critical").offset;
  let critical = 0;
  for (let from = 0; from < data.length; from += cloud.point_stride) critical += data[from + at];
  demand(critical === match.critical_rays, "/scan: not as many critical points as rays");
});

// The tiles, put together, are the last picture of the map.
const tiles = new Map();
for (const message of of("/map/tiles")) {
  if (message.fresh) tiles.clear();
  for (const tile of message.tiles) tiles.set(`${tile.x},${tile.y}`, tile);
}
const map = of("/map").at(-1), picture = Buffer.from(map.data, "base64");
const resolution = of("/map/tiles").at(-1).resolution_m, side = of("/map/tiles").at(-1).side_cells;
demand(map.cell_size.x === resolution, "/map is coarser than the tiles");
let known = 0, differ = 0, shown = 0;
for (const {x, y, data} of tiles.values()) {
  const cells = Buffer.from(data, "base64");
  const column = x - Math.round(map.pose.position.x / resolution), row = y - Math.round(map.pose.position.y / resolution);
  cells.forEach((cell, i) => {
    known += cell !== 255 ? 1 : 0;
    differ += picture[(row + Math.floor(i / side)) * map.row_stride + column + (i % side)] !== cell ? 1 : 0;
  });
}
for (const cell of picture) shown += cell !== 255 ? 1 : 0;
demand(known > 1000 && differ === 0 && shown === known, `/map: ${known} cells in tiles, ${shown} in the picture, ${differ} differ`);
console.log(`${indexed} messages on ${topics.size} channels, ${all.chunkCount} chunks; ${poses.length} poses as in the trajectory; ` +
  `${tiles.size} tiles, ${known} cells known`);
