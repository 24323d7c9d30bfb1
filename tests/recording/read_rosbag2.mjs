// read_rosbag2.mjs DIR RECORDING: decodes every message of a rosbag2 folder's database with the definitions of the
// recording that it was made of, and prints as JSON how many there are of each topic.
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";
import initSqlJs from "sql.js";
import { decode, parseDefinition } from "./definitions.mjs";

function definitionsOf(file) {
  const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };
  const reader = new McapStreamReader({ decompressHandlers });
  reader.append(readFileSync(file));
  const definitions = new Map();
  for (let record = reader.nextRecord(); record !== undefined; record = reader.nextRecord()) {
    if (record.type !== "Schema" || definitions.has(record.name)) continue;
    definitions.set(record.name, parseDefinition(record.name, new TextDecoder().decode(record.data)));
  }
  return definitions;
}

const [folder, recording] = process.argv.slice(2);
const databases = readdirSync(folder).filter((name) => name.endsWith(".db3"));
if (databases.length !== 1) throw new Error(`${databases.length} databases in ${folder}`);
const sqlite = await initSqlJs();
const database = new sqlite.Database(readFileSync(join(folder, databases[0])));
const definitions = definitionsOf(recording);
const topics = {};
let before = 0;
const rows = database.prepare(
  "SELECT topics.name, topics.type, topics.serialization_format, messages.timestamp, messages.data" +
    " FROM messages JOIN topics ON topics.id = messages.topic_id ORDER BY messages.id",
);
while (rows.step()) {
  const [name, type, format, timestamp, data] = rows.get();
  if (format !== "cdr") throw new Error(`${name}: ${format}`);
  if (timestamp < before) throw new Error(`${name}: time ${timestamp} after ${before}`);
  before = timestamp;
  decode(definitions.get(type), data);
  const topic = (topics[name] ??= { type, count: 0 });
  topic.count += 1;
}
console.log(JSON.stringify({ topics }));
