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

/** Decodes a message of the service; its `body` has `case` and `value`. */
export const decodeServer = (bytes) => fromBinary(server, bytes);
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
