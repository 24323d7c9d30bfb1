import type { RequestBody } from "../protocol/codec";
import type { ServerMessage } from "../protocol/generated/console_pb";
import type { Outcome } from "./requests";
import type { Timing } from "./timing";

/** How the page hears of the service. */
export type Link =
  /** No Welcome yet. */
  | { readonly state: "connecting" }
  | { readonly state: "live" }
  /** Connected, but nothing came for `staleAfter`; `since`: page time of the newest message. */
  | { readonly state: "stale"; readonly since: number }
  /** Tries again at `retryAt`, page time. */
  | { readonly state: "lost"; readonly attempt: number; readonly retryAt: number }
  /** The service wants this page no more. */
  | { readonly state: "closed"; readonly reason: string };

export interface ConnectionEvents {
  linkChanged(link: Link): void;
  /** Welcome, Updates and Frame; the rest stays within the connection. */
  received(message: ServerMessage): void;
  timingChanged(timing: Timing): void;
}

/** What the page has of the service's state, see Hello. */
export interface Known {
  readonly run: string;
  readonly sequence: bigint;
}

export interface RequestOptions {
  readonly world?: string;
  /** s of wall time; default `validFor`. */
  readonly validFor?: number;
}

/** The console's way to the operator service. */
export interface Connection {
  readonly link: Link;
  start(): void;
  /** For good. */
  stop(): void;
  /** Kept until answered or too old, also while the connection is lost; never rejected. */
  request(body: RequestBody, options?: RequestOptions): Promise<Outcome>;
  /** All that `received` has told of is shown: the service sends more only then. */
  shown(): void;
  /** Somebody uses the page; the service hears of it now and then. */
  used(): void;
  /** Which robot's frames to send from now on; undefined = none. */
  attend(robot: string | undefined): void;
  seek(to: { position?: number; speed?: number }): void;
  /** Wall time of the service, s since 1970; undefined before the first Welcome. */
  serviceTime(): number | undefined;
}

export const pingPeriod = 0.5;
/** s between two pings that say that the page is used. */
export const usedPeriod = 5;
export const staleAfter = 1.5;
/** A connection that says nothing for so long is given up. */
export const deadAfter = 6;
export const validFor = 5;
