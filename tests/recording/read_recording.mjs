// read_recording.mjs FILE [--last TOPIC]...: decodes every message of an MCAP file with the definitions in it, and prints
// as JSON what is in it. Fails with the reason for anything that is not as the formats want it.
import { open } from "node:fs/promises";
import { parseArgs } from "node:util";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";
import { decode, parseDefinition, plain } from "./definitions.mjs";

const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };

class OpenFile {
  constructor(handle, length) {
    this.handle = handle;
    this.length = length;
  }
  async size() {
    return BigInt(this.length);
  }
  async read(offset, length) {
    const bytes = new Uint8Array(Number(length));
    const { bytesRead } = await this.handle.read(bytes, 0, bytes.length, Number(offset));
    if (bytesRead !== bytes.length) throw new Error(`${bytesRead} of ${bytes.length} bytes at ${offset}`);
    return bytes;
  }
}

/** Decodes messages; keeps counts, times and the last message of the topics that are asked for. */
class Decoder {
  topics = {};
  types = new Map();

  add(channel, schema, message) {
    if (channel.messageEncoding !== "cdr" || schema.encoding !== "ros2msg") {
      throw new Error(`${channel.topic}: ${channel.messageEncoding} by ${schema.encoding}`);
    }
    if (!this.types.has(schema.name)) {
      this.types.set(schema.name, parseDefinition(schema.name, new TextDecoder().decode(schema.data)));
    }
    const topic = (this.topics[channel.topic] ??= { type: schema.name, count: 0, sequence: 0 });
    topic.count += 1;
    if (message.sequence !== ++topic.sequence) throw new Error(`${channel.topic}: ${message.sequence} is out of sequence`);
    try {
      topic.last = decode(this.types.get(schema.name), message.data);
    } catch (error) {
      throw new Error(`${channel.topic}, message ${topic.count}: ${error.message}`);
    }
    topic.publish_time_s = Number(message.publishTime) / 1e9;
  }
}

/** Record by record, as it is in the file; says whether the file was finished. CRCs are checked. */
async function stream(file, decoder) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  const schemas = new Map();
  const channels = new Map();
  const found = { metadata: {}, finished: false, chunks: 0 };
  reader.append(await file.read(0n, await file.size()));
  for (let record = reader.nextRecord(); record !== undefined; record = reader.nextRecord()) {
    if (record.type === "Header") Object.assign(found, { profile: record.profile, library: record.library });
    if (record.type === "Metadata") found.metadata[record.name] = Object.fromEntries(record.metadata);
    if (record.type === "Footer") found.finished = reader.done();
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "ChunkIndex") found.chunks += 1;
    if (record.type !== "Message") continue;
    const channel = channels.get(record.channelId);
    decoder.add(channel, schemas.get(channel.schemaId), record);
  }
  return found;
}

/** By the summary and the message indexes, in the order of log times. Returns the count. */
async function readByIndex(file) {
  const reader = await McapIndexedReader.Initialize({ readable: file, decompressHandlers });
  const counts = {};
  let before = 0n;
  for await (const message of reader.readMessages()) {
    if (message.logTime < before) throw new Error(`log time ${message.logTime} after ${before}`);
    before = message.logTime;
    const { topic } = reader.channelsById.get(message.channelId);
    counts[topic] = (counts[topic] ?? 0) + 1;
  }
  for (const [id, count] of reader.statistics.channelMessageCounts) {
    const { topic } = reader.channelsById.get(id);
    if (Number(count) !== counts[topic]) throw new Error(`${topic}: statistics say ${count}, indexes ${counts[topic]}`);
  }
  return counts;
}

const { values, positionals } = parseArgs({
  options: { last: { type: "string", multiple: true, default: [] } },
  allowPositionals: true,
});
const handle = await open(positionals[0]);
const file = new OpenFile(handle, (await handle.stat()).size);
const decoder = new Decoder();
const found = await stream(file, decoder);
if (found.finished) {
  for (const [topic, count] of Object.entries(await readByIndex(file))) {
    if (decoder.topics[topic].count !== count) throw new Error(`${topic}: ${count} by index, ${decoder.topics[topic].count} in the file`);
  }
}
const topics = Object.fromEntries(
  Object.entries(decoder.topics).map(([name, { last, sequence, ...topic }]) => [
    name,
    values.last.includes(name) ? { ...topic, last: plain(last) } : topic,
  ]),
);
console.log(JSON.stringify({ ...found, topics }));
await handle.close();
