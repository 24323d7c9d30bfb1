import type { MessageInitShape } from "@bufbuild/protobuf";
import { create, fromBinary, toBinary } from "@bufbuild/protobuf";
import type { ServerMessage } from "./generated/console_pb";
import {
  ClientMessageSchema,
  type RequestSchema,
  ServerMessageSchema,
} from "./generated/console_pb";

/** What a ClientMessage can hold, fields at their defaults left out. */
export type ClientBody = NonNullable<MessageInitShape<typeof ClientMessageSchema>["body"]>;

/** What a Request can ask for, likewise. */
export type RequestBody = NonNullable<MessageInitShape<typeof RequestSchema>["body"]>;

export function encode(body: ClientBody): Uint8Array<ArrayBuffer> {
  return new Uint8Array(toBinary(ClientMessageSchema, create(ClientMessageSchema, { body })));
}

/** Undefined for what is no ServerMessage, or one of a kind that this page does not know. */
export function decode(data: ArrayBuffer): ServerMessage | undefined {
  try {
    const message = fromBinary(ServerMessageSchema, new Uint8Array(data));
    return message.body.case === undefined ? undefined : message;
  } catch {
    return undefined;
  }
}
