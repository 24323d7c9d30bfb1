import type { Layout, RequestBody } from "../protocol/codec";
import type { ServerMessage } from "../protocol/generated/console_pb";
import type { Outcome } from "./requests";
import type { Timing } from "./timing";

/** State of the connection to the service. */
export type Link =
  /** No Welcome yet. */
  | { readonly state: "connecting" }
  | { readonly state: "live" }
  /** Connected, but silent for `staleAfter`; `since`: page time of the newest message. */
  | { readonly state: "stale"; readonly since: number }
  /** The next attempt is at `retryAt`, page time. */
  | { readonly state: "lost"; readonly attempt: number; readonly retryAt: number }
  /** The service has rejected this page. */
  | { readonly state: "closed"; readonly reason: string };

export interface ConnectionEvents {
  linkChanged(link: Link): void;
  /** Welcome, Updates and Frame; the connection handles all others itself. */
  received(message: ServerMessage): void;
  timingChanged(timing: Timing): void;
}

/** How much of the service's state the page has; see Hello. */
export interface Known {
  readonly run: string;
  readonly sequence: bigint;
}

export interface RequestOptions {
  readonly world?: string;
  /** s of wall time; default `validFor`. */
  readonly validFor?: number;
}

/** The console's connection to the operator service. */
export interface Connection {
  readonly link: Link;
  start(): void;
  /** Ends the connection for good. */
  stop(): void;
  /** Kept until answered or expired, also while the connection is lost. The promise never rejects. */
  request(body: RequestBody, options?: RequestOptions): Promise<Outcome>;
  /** All messages given to `received` are on screen. Only then does the service send more. */
  shown(): void;
  /** Somebody uses the page; reported to the service from time to time. */
  used(): void;
  /** Selects the robots whose frames the service sends, and those whose search reports it gets. */
  attend(robots: readonly string[], searches: readonly string[]): void;
  /**
   * From then on the person has this name for others. Reconnects: the service knows pages by their name. First waits for the
   * answers to requests, which the service would take for another page's under the new name.
   */
  rename(name: string): Promise<void>;
  /** Where the page shows what; told to each service that it connects to. */
  layout(layout: Layout): void;
  seek(to: { position?: number; speed?: number }): void;
  /** Wall time of the service, s since 1970; undefined before the first Welcome. */
  serviceTime(): number | undefined;
}

export const pingPeriod = 0.5;
/** s between two pings that report activity. */
export const usedPeriod = 5;
export const staleAfter = 1.5;
/** A connection that is silent this long is closed. */
export const deadAfter = 6;
export const validFor = 5;
