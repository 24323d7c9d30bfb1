import type { MessageInitShape } from "@bufbuild/protobuf";
import { create, fromBinary, toBinary } from "@bufbuild/protobuf";
import type { ServerMessage } from "./generated/console_pb";
import {
  ClientMessageSchema,
  type RequestSchema,
  ServerMessageSchema,
} from "./generated/console_pb";

/** Body of a ClientMessage; fields at their defaults may be left out. */
export type ClientBody = NonNullable<MessageInitShape<typeof ClientMessageSchema>["body"]>;

/** Body of a Request, likewise. */
export type RequestBody = NonNullable<MessageInitShape<typeof RequestSchema>["body"]>;

export function encode(body: ClientBody): Uint8Array<ArrayBuffer> {
  return new Uint8Array(toBinary(ClientMessageSchema, create(ClientMessageSchema, { body })));
}

/** Undefined if `data` is no ServerMessage, or has a body that this page does not know. */
export function decode(data: ArrayBuffer): ServerMessage | undefined {
  try {
    const message = fromBinary(ServerMessageSchema, new Uint8Array(data));
    return message.body.case === undefined ? undefined : message;
  } catch {
    return undefined;
  }
}
