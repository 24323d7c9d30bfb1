import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { create, createFileRegistry, fromBinary, toBinary } from "@bufbuild/protobuf";
import { FileDescriptorSetSchema } from "@bufbuild/protobuf/wkt";

const idl = resolve(dirname(fileURLToPath(import.meta.url)), "../../../idl");
const registry = createFileRegistry(fromBinary(FileDescriptorSetSchema, compile()));

function compile() {
  const folder = mkdtempSync(join(tmpdir(), "conav-protocol-"));
  const file = join(folder, "console.binpb");
  execFileSync("protoc", ["-I", idl, `--descriptor_set_out=${file}`, "console.proto"]);
  const bytes = readFileSync(file);
  rmSync(folder, { recursive: true });
  return bytes;
}

function messageType(name) {
  const found = registry.getMessage(`conav.console.${name}`);
  if (found === undefined) throw new Error(`idl/console.proto has no message ${name}`);
  return found;
}

const server = messageType("ServerMessage");
const client = messageType("ClientMessage");

/** Decodes a message of the service; its `body` has `case` and `value`, and its grids are unpacked. */
export function decodeServer(bytes) {
  const message = fromBinary(server, bytes);
  const updates = message.body.case === "updates" ? message.body.value.update : [];
  for (const { body } of updates) {
    for (const field of grids[body.case] ?? []) body.value[field] = unpacked(body.value[field]);
  }
  return message;
}

/** Fields that are grids. */
const grids = {
  belief: ["walls", "initialWalls"],
  seen: ["cells"],
  truth: ["cells"],
  prediction: ["add", "remove"],
};

/** The cells of a grid as idl/console.proto packs it. */
function unpacked(bytes) {
  const cells = [];
  let at = 0;
  const varint = () => {
    const byte = bytes[at++];
    return byte < 128 ? byte : byte - 128 + 128 * varint();
  };
  const columns = varint();
  while (at < bytes.length) {
    const end = cells.length + varint();
    const difference = bytes[at++];
    while (cells.length < end) cells.push(difference ^ (cells[cells.length - columns] ?? 0));
  }
  return Uint8Array.from(cells);
}

export const decodeClient = (bytes) => fromBinary(client, bytes);
/** @param {{ case: string, value: object }} body */
export const encodeClient = (body) => toBinary(client, create(client, { body }));

/** The number of `name` in an enumeration. */
export function numberOf(enumeration, name) {
  const found = registry
    .getEnum(`conav.console.${enumeration}`)
    ?.values.find((one) => one.name === name);
  if (found === undefined) throw new Error(`idl/console.proto has no ${enumeration}.${name}`);
  return found.number;
}
