import { create, fromBinary, type MessageInitShape, toBinary } from "@bufbuild/protobuf";
import type { Layout, RequestBody } from "../protocol/codec";
import {
  type ClientMessage,
  ClientMessageSchema,
  type Request,
  ServerMessageSchema,
} from "../protocol/generated/console_pb";
import type { Cancel, Clock } from "./clock";
import type { Connection, Link, RequestOptions } from "./connection";
import type { Outcome } from "./requests";
import type { Socket, SocketEvents, SocketFactory } from "./socket";

interface Timer {
  at: number;
  readonly period: number | undefined;
  readonly act: () => void;
}

/** A clock that tests advance. */
export class FakeClock implements Clock {
  time = 1000;
  chance = 0.5;
  #timers = new Set<Timer>();

  now(): number {
    return this.time;
  }

  random(): number {
    return this.chance;
  }

  every(seconds: number, act: () => void): Cancel {
    return this.#add({ at: this.time + seconds, period: seconds, act });
  }

  after(seconds: number, act: () => void): Cancel {
    return this.#add({ at: this.time + seconds, period: undefined, act });
  }

  advance(seconds: number): void {
    const end = this.time + seconds;
    for (let timer = this.#next(end); timer; timer = this.#next(end)) {
      this.time = timer.at;
      if (timer.period === undefined) this.#timers.delete(timer);
      else timer.at += timer.period;
      timer.act();
    }
    this.time = end;
  }

  #add(timer: Timer): Cancel {
    this.#timers.add(timer);
    return () => this.#timers.delete(timer);
  }

  #next(end: number): Timer | undefined {
    const due = [...this.#timers].filter(({ at }) => at <= end + 1e-9);
    return due.sort((a, b) => a.at - b.at)[0];
  }
}

export type ServerBody = NonNullable<MessageInitShape<typeof ServerMessageSchema>["body"]>;

/** The service's end of a socket, controlled by a test. */
class FakeSocket implements Socket {
  readonly sent: ClientMessage[] = [];
  closed = false;
  readonly #events: SocketEvents;

  constructor(events: SocketEvents) {
    this.#events = events;
  }

  send(data: Uint8Array<ArrayBuffer>): void {
    this.sent.push(fromBinary(ClientMessageSchema, data));
  }

  close(): void {
    this.closed = true;
  }

  open(): void {
    this.#events.opened();
  }

  break(): void {
    this.#events.closed();
  }

  say(body: ServerBody): void {
    const bytes = toBinary(ServerMessageSchema, create(ServerMessageSchema, { body }));
    this.#events.received(new Uint8Array(bytes).buffer);
  }

  requests(): Request[] {
    return this.sent.flatMap(({ body }) => (body.case === "request" ? [body.value] : []));
  }

  ofCase(name: ClientMessage["body"]["case"]): ClientMessage[] {
    return this.sent.filter(({ body }) => body.case === name);
  }
}

/** All sockets that the connection opened, newest last. */
export class FakeService {
  readonly sockets: FakeSocket[] = [];
  readonly factory: SocketFactory = (events) => {
    const socket = new FakeSocket(events);
    this.sockets.push(socket);
    return socket;
  };

  get newest(): FakeSocket {
    const socket = this.sockets.at(-1);
    if (socket === undefined) throw new Error("no socket was opened");
    return socket;
  }
}

/** A Connection that records requests and accepts them unless `outcome` says otherwise. */
export class FakeConnection implements Connection {
  link: Link = { state: "live" };
  outcome: Outcome = { kind: "accepted", revision: 1 };
  /** Outcomes of the next requests; afterwards `outcome` applies. */
  outcomes: Outcome[] = [];
  time: number | undefined = 5000;
  readonly asked: RequestBody[] = [];
  readonly options: RequestOptions[] = [];
  readonly sought: { position?: number; speed?: number }[] = [];
  readonly layouts: Layout[] = [];
  attended: readonly string[] = [];
  searches: readonly string[] = [];
  name = "";
  uses = 0;

  start(): void {}
  stop(): void {}
  shown(): void {}

  request(body: RequestBody, options: RequestOptions = {}): Promise<Outcome> {
    this.asked.push(body);
    this.options.push(options);
    return Promise.resolve(this.outcomes.shift() ?? this.outcome);
  }

  used(): void {
    this.uses += 1;
  }

  attend(robots: readonly string[], searches: readonly string[]): void {
    this.attended = robots;
    this.searches = searches;
  }

  async rename(name: string): Promise<void> {
    this.name = name;
  }

  layout(layout: Layout): void {
    this.layouts.push(layout);
  }

  seek(to: { position?: number; speed?: number }): void {
    this.sought.push(to);
  }

  serviceTime(): number | undefined {
    return this.time;
  }
}
