import { type ClientBody, decode, encode, type Layout, type RequestBody } from "../protocol/codec";
import type { ServerMessage } from "../protocol/generated/console_pb";
import type { Cancel, Clock } from "./clock";
import {
  type Connection,
  type ConnectionEvents,
  deadAfter,
  type Known,
  type Link,
  pingPeriod,
  type RequestOptions,
  staleAfter,
  usedPeriod,
  validFor,
} from "./connection";
import type { Identity } from "./identity";
import { type Outcome, type PendingRequest, PendingRequests } from "./requests";
import type { Socket, SocketFactory } from "./socket";
import { TimingFilter } from "./timing";

/** s between two checks for silence. */
const watchPeriod = 0.25;

interface ConnectionParts {
  readonly sockets: SocketFactory;
  readonly clock: Clock;
  readonly identity: Identity;
  readonly known: () => Known;
  readonly events: ConnectionEvents;
}

/** A Connection over one socket at a time; reconnects by itself. */
export class ServiceConnection implements Connection {
  #parts: ConnectionParts;
  #link: Link = { state: "connecting" };
  #socket: Socket | undefined;
  #requests: PendingRequests;
  #timing = new TimingFilter();
  #name: string;
  /** Reconnects under another name, which is no loss of the link. */
  #isRenaming = false;
  #attended: Readonly<Record<"robots" | "searches", readonly string[]>> = {
    robots: [],
    searches: [],
  };
  #layout: Layout | undefined;
  #attempt = 0;
  #receivedAt = 0;
  #welcomed = false;
  /** Updates and frames on this connection: received, and acknowledged to the service as shown. */
  #received = 0n;
  #taken = 0n;
  #pingedAt = Number.NEGATIVE_INFINITY;
  #isUsed = false;
  #usedAt = Number.NEGATIVE_INFINITY;
  #cancelWatch: Cancel = () => undefined;
  #cancelRetry: Cancel = () => undefined;

  constructor(parts: ConnectionParts) {
    this.#parts = parts;
    this.#requests = new PendingRequests(parts.identity.idsAbove);
    this.#name = parts.identity.name;
  }

  get link(): Link {
    return this.#link;
  }

  start(): void {
    this.#cancelWatch = this.#parts.clock.every(watchPeriod, () => this.#watch());
    this.#open();
  }

  stop(): void {
    this.#end("this page was closed");
  }

  request(body: RequestBody, options: RequestOptions = {}): Promise<Outcome> {
    const now = this.serviceTime();
    if (this.#link.state === "closed" || now === undefined) {
      return Promise.resolve({ kind: "not sent", reason: "not sent: no connection" });
    }
    const until = now + (options.validFor ?? validFor);
    const [request, outcome] = this.#requests.add(body, options.world ?? "", until);
    if (this.#welcomed) this.#sendRequest(request);
    return outcome;
  }

  shown(): void {
    if (!this.#welcomed || this.#received === this.#taken) return;
    this.#taken = this.#received;
    this.#send({ case: "taken", value: { messages: this.#taken } });
  }

  used(): void {
    this.#isUsed = true;
  }

  attend(robots: readonly string[], searches: readonly string[]): void {
    if (JSON.stringify({ robots, searches }) === JSON.stringify(this.#attended)) return;
    this.#attended = { robots, searches };
    if (this.#welcomed) this.#sendAttend();
  }

  async rename(name: string): Promise<void> {
    if (name === this.#name) return;
    while (this.#requests.size > 0) await this.#requests.settled();
    this.#name = name;
    if (this.#link.state !== "live" && this.#link.state !== "stale") return;
    this.#isRenaming = true;
    this.#drop();
    this.#open();
  }

  layout(layout: Layout): void {
    this.#layout = layout;
    if (this.#welcomed) this.#send({ case: "layout", value: layout });
  }

  seek(to: { position?: number; speed?: number }): void {
    if (this.#welcomed) this.#send({ case: "seek", value: to });
  }

  serviceTime(): number | undefined {
    const now = this.#parts.clock.now();
    const { clockOffset } = this.#timing.timing(now);
    return clockOffset === undefined ? undefined : now + clockOffset;
  }

  #open(): void {
    this.#welcomed = false;
    this.#received = 0n;
    this.#taken = 0n;
    this.#receivedAt = this.#parts.clock.now();
    this.#setLink({ state: "connecting" });
    // Ignore events of a socket that was closed.
    const current = () => this.#socket === socket;
    const socket = this.#parts.sockets({
      opened: () => current() && this.#sendHello(),
      received: (data) => current() && this.#receive(data),
      closed: () => current() && this.#lose(),
    });
    this.#socket = socket;
  }

  #sendHello(): void {
    const { token, instance, experimenter } = this.#parts.identity;
    const hello = { token, name: this.#name, instance, experimenter, saysTaken: true };
    this.#send({ case: "hello", value: { ...hello, ...this.#parts.known() } });
  }

  #receive(data: ArrayBuffer): void {
    const message = decode(data);
    this.#receivedAt = this.#parts.clock.now();
    if (message === undefined) return;
    if (this.#link.state === "stale") this.#setLink({ state: "live" });
    this.#dispatch(message);
  }

  #dispatch(message: ServerMessage): void {
    const { body } = message;
    switch (body.case) {
      case "pong":
        this.#timing.answered(body.value.pageTime, body.value.serviceTime, this.#receivedAt);
        this.#publishTiming();
        break;
      case "reply":
        this.#requests.answer(body.value);
        break;
      case "goodbye":
        if (body.value.retry) this.#lose();
        else this.#end(body.value.reason);
        break;
      case "welcome":
        this.#timing.welcomed(body.value.serviceTime, this.#receivedAt);
        this.#parts.events.received(message);
        this.#begin();
        break;
      default:
        this.#received += 1n;
        this.#parts.events.received(message);
    }
  }

  /** After the Welcome: sends waiting requests first, in order. */
  #begin(): void {
    this.#welcomed = true;
    this.#attempt = 0;
    this.#setLink({ state: "live" });
    const now = this.serviceTime() ?? 0;
    this.#requests.expire(now);
    for (const request of this.#requests.toSend(now)) this.#sendRequest(request);
    const { robots, searches } = this.#attended;
    if (robots.length + searches.length > 0) this.#sendAttend();
    if (this.#layout !== undefined) this.layout(this.#layout);
    this.#ping();
  }

  #watch(): void {
    const now = this.#parts.clock.now();
    this.#requests.expire(this.serviceTime() ?? 0);
    if (this.#socket !== undefined && now - this.#receivedAt >= deadAfter) this.#lose();
    if (!this.#welcomed) return;
    if (now - this.#receivedAt >= staleAfter && this.#link.state === "live") {
      this.#setLink({ state: "stale", since: this.#receivedAt });
    }
    if (now - this.#pingedAt >= pingPeriod) this.#ping();
    this.#publishTiming();
  }

  #ping(): void {
    this.#pingedAt = this.#parts.clock.now();
    this.#timing.sent(this.#pingedAt);
    const measuredRoundTrip = this.#timing.measured();
    const active = this.#reportsUse();
    this.#send({ case: "ping", value: { pageTime: this.#pingedAt, measuredRoundTrip, active } });
  }

  #reportsUse(): boolean {
    if (!this.#isUsed || this.#pingedAt - this.#usedAt < usedPeriod) return false;
    this.#isUsed = false;
    this.#usedAt = this.#pingedAt;
    return true;
  }

  #lose(): void {
    this.#drop();
    const { clock } = this.#parts;
    const wait = backoff(this.#attempt, clock.random());
    this.#attempt += 1;
    this.#setLink({ state: "lost", attempt: this.#attempt, retryAt: clock.now() + wait });
    this.#cancelRetry = clock.after(wait, () => this.#open());
  }

  #end(reason: string): void {
    this.#cancelWatch();
    this.#drop();
    this.#requests.giveUp(`not sent: ${reason}`);
    this.#setLink({ state: "closed", reason });
  }

  #drop(): void {
    this.#cancelRetry();
    const socket = this.#socket;
    this.#socket = undefined;
    this.#welcomed = false;
    this.#pingedAt = Number.NEGATIVE_INFINITY;
    this.#timing.forget();
    socket?.close();
    this.#publishTiming();
  }

  #sendRequest(request: PendingRequest): void {
    request.sent = true;
    const { id, validUntil, world, body } = request;
    this.#send({ case: "request", value: { id, validUntil, world, body } });
  }

  #sendAttend(): void {
    const { robots, searches } = this.#attended;
    this.#send({ case: "attend", value: { robots: [...robots], searches: [...searches] } });
  }

  #send(body: ClientBody): void {
    this.#socket?.send(encode(body));
  }

  #setLink(link: Link): void {
    this.#link = link;
    if (this.#isRenaming && link.state === "connecting") return;
    this.#isRenaming = false;
    this.#parts.events.linkChanged(link);
  }

  #publishTiming(): void {
    this.#parts.events.timingChanged(this.#timing.timing(this.#parts.clock.now()));
  }
}

const shortestWait = 0.25;
const longestWait = 4;

/** s to wait before an attempt: doubles each time, half of it random so that pages do not all reconnect at once. */
export function backoff(attempt: number, random: number): number {
  const full = Math.min(longestWait, shortestWait * 2 ** Math.max(0, attempt));
  return Math.max(shortestWait, full * (0.5 + random / 2));
}
