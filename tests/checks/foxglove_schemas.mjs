// node foxglove_schemas.mjs FILE.mcap
//
// Holds each message of an export, and the schema that its channel announces, against @foxglove/schemas; controls are
// messages that are wrong.
import {execFileSync} from "node:child_process";
import {readFileSync} from "node:fs";
import {createRequire} from "node:module";

const require = createRequire(process.env.NODE_PATH + "/");
const {McapStreamReader} = require("@mcap/core");
const Ajv = require("ajv").default;
const official = require("@foxglove/schemas/jsonschema");

function demand(so, what) {
  if (!so) throw new Error(what);
}

const ajv = new Ajv({allErrors: true, strict: true});
const checks = new Map();  // by the schema's text
function complaints(schema, message) {
  const key = JSON.stringify(schema);
  if (!checks.has(key)) checks.set(key, ajv.compile(schema));
  const check = checks.get(key);
  return check(message) ? "" : ajv.errorsText(check.errors);
}

// What is announced has all that is wanted, in the same form: descriptions apart.
function same(ours, theirs, at) {
  if (theirs === null || typeof theirs !== "object") {
    demand(ours === theirs, `${at}: ${ours} is announced, ${theirs} is said`);
    return;
  }
  for (const [key, value] of Object.entries(theirs)) {
    if (["description", "$comment", "required"].includes(key) || key === "title" && at.endsWith(".items")) continue;
    demand(ours?.[key] !== undefined, `${at}.${key} is not announced`);
    same(ours[key], value, `${at}.${key}`);
  }
}

const stream = new McapStreamReader({
  decompressHandlers: {zstd: packed => execFileSync("zstd", ["-dcq"], {input: packed, maxBuffer: 1 << 30})},
});
stream.append(readFileSync(process.argv[2]));
const text = new TextDecoder("utf-8", {fatal: true});
const schemas = new Map(), channels = new Map(), counts = new Map(), samples = new Map();
for (let record; (record = stream.nextRecord());) {
  if (record.type === "Schema") schemas.set(record.id, {name: record.name, ours: JSON.parse(text.decode(record.data))});
  if (record.type === "Channel") channels.set(record.id, record);
  if (record.type !== "Message") continue;
  const {topic, schemaId} = channels.get(record.channelId), {name, ours} = schemas.get(schemaId);
  const message = JSON.parse(text.decode(record.data));
  const theirs = name.startsWith("foxglove.") ? official[name.slice("foxglove.".length)] : undefined;
  demand(!name.startsWith("foxglove.") || theirs, `${name} is none of theirs`);
  for (const schema of theirs ? [ours, theirs] : [ours]) {
    const wrong = complaints(schema, message);
    demand(wrong === "", `${topic}, ${schema === ours ? "as announced" : name}: ${wrong}`);
  }
  if (theirs && !samples.has(topic)) same(ours, theirs, name);
  samples.set(topic, {message, theirs});
  counts.set(topic, (counts.get(topic) ?? 0) + 1);
}
for (const topic of ["/tf", "/pose", "/path", "/scan", "/map", "/log", "/map/tiles", "/match", "/status", "/diagnostics"]) {
  demand(counts.get(topic) > 0, `no message on ${topic}`);
}

// The controls: each is seen.
const plant = (topic, change) => {
  const {message, theirs} = samples.get(topic), wrong = structuredClone(message);
  change(wrong);
  demand(complaints(theirs, wrong) !== "", `a wrong message on ${topic} is not seen: ${change}`);
};
plant("/pose", m => { delete m.frame_id; });
plant("/pose", m => { m.pose.position.x = "1"; });
plant("/tf", m => { m.transforms[0].timestamp.nsec = 1e9; });
plant("/scan", m => { m.fields[0].type = 99; });
plant("/map", m => { m.column_count = -1; });
plant("/path", m => { delete m.poses[0].orientation.w; });
plant("/log", m => { m.level = "info"; });
const announced = structuredClone(official.Grid);
announced.properties.column_count.type = "number";
let seen = false;
try { same(announced, official.Grid, "foxglove.Grid"); } catch { seen = true; }
demand(seen, "a wrong announcement is not seen");
console.log(`${[...counts.values()].reduce((a, b) => a + b)} messages on ${counts.size} channels are as @foxglove/schemas ` +
  `${require("@foxglove/schemas/package.json").version} and their own announcements say`);
