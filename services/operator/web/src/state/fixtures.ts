// Builders of states, for tests of state and panels.
import { create } from "@bufbuild/protobuf";
import type { ServerBody } from "../connection/fake";
import {
  Mode,
  Role,
  type ServerMessage,
  ServerMessageSchema,
} from "../protocol/generated/console_pb";
import { type ConsoleState, emptyState } from "./console_state";
import { reduce } from "./reduce";

type UpdatesInit = Extract<ServerBody, { case: "updates" }>["value"];
export type UpdateBody = NonNullable<NonNullable<UpdatesInit["update"]>[number]["body"]>;

export function message(body: ServerBody): ServerMessage {
  return create(ServerMessageSchema, { body });
}

/** One message with all of `bodies`, numbered from `first`. */
export function updates(bodies: UpdateBody[], first = 1n, everything = false): ServerMessage {
  const update = bodies.map((body, index) => ({ sequence: first + BigInt(index), body }));
  return message({ case: "updates", value: { update, everything } });
}

export function stateOf(...bodies: UpdateBody[]): ConsoleState {
  return reduce(reduce(emptyState, welcomeMessage()), updates(bodies));
}

interface WelcomeInit {
  run?: string;
  resumed?: boolean;
  client?: string;
  role?: Role;
  mode?: Mode;
}

export function welcomeMessage(given: WelcomeInit = {}): ServerMessage {
  const limits = {
    driveAdvisedAgainst: 0.3,
    driveRefused: 1,
    guidanceValidFor: 600,
    controlTime: 60,
    editCells: 100,
    pathCells: 100,
  };
  const usual = { run: "run-1", client: "me", role: Role.OPERATOR, mode: Mode.SUPERVISE };
  return message({ case: "welcome", value: { ...usual, limits, ...given } });
}
