import type { MessageInitShape } from "@bufbuild/protobuf";
import { create, fromBinary, toBinary } from "@bufbuild/protobuf";
import type { ServerMessage, Update } from "./generated/console_pb";
import {
  ClientMessageSchema,
  type PageLayoutSchema,
  type RequestSchema,
  ServerMessageSchema,
} from "./generated/console_pb";
import { unpackGrid } from "./packed_grid";

/** Body of a ClientMessage; fields at their defaults may be left out. */
export type ClientBody = NonNullable<MessageInitShape<typeof ClientMessageSchema>["body"]>;

/** Body of a PageLayout, likewise. */
export type Layout = MessageInitShape<typeof PageLayoutSchema>;

/** Body of a Request, likewise. */
export type RequestBody = NonNullable<MessageInitShape<typeof RequestSchema>["body"]>;

export function encode(body: ClientBody): Uint8Array<ArrayBuffer> {
  return new Uint8Array(toBinary(ClientMessageSchema, create(ClientMessageSchema, { body })));
}

/** Its grids are unpacked. Undefined if `data` is no ServerMessage, or has a body that this page does not know. */
export function decode(data: ArrayBuffer): ServerMessage | undefined {
  try {
    const message = fromBinary(ServerMessageSchema, new Uint8Array(data));
    if (message.body.case === "updates") message.body.value.update.forEach(unpackGrids);
    return message.body.case === undefined ? undefined : message;
  } catch {
    return undefined;
  }
}

function unpackGrids({ body }: Update): void {
  switch (body.case) {
    case "belief":
      body.value.walls = unpackGrid(body.value.walls);
      body.value.initialWalls = unpackGrid(body.value.initialWalls);
      break;
    case "seen":
    case "truth":
      body.value.cells = unpackGrid(body.value.cells);
      break;
    case "prediction":
      body.value.add = unpackGrid(body.value.add);
      body.value.remove = unpackGrid(body.value.remove);
  }
}
