#!/usr/bin/python3
"""pupil_standin.py [OPTIONS]: Pupil Capture's network interface, with a synthetic recording behind it.

Answers Pupil Remote (ZeroMQ REQ) and publishes the messages of tests/unit/study/gaze/golden_test.py on its bus, with the quirks of real
ones, encoded by the msgpack package. Nothing of it is conav's. Prints "pupil remote tcp://127.0.0.1:PORT" when it is ready. The clock
begins at the recording's first time; with --speed 0 messages go out at --rate whatever their times are, when a line "go" comes in.
"""
import argparse
import heapq
import json
import pathlib
import select
import sys
import threading
import time

import msgpack
import zmq

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "unit/study/gaze"))
import golden_test as golden  # noqa: E402


def messages_of(world, samples):
    """(time of sending, message) in the order of sending."""
    pupils = [(time, golden.pupil_message(time, eye, confidence, diameter, method))
              for time, eye, confidence, diameter in samples for method in ("2d", "3d")]
    gaze = [(time, golden.gaze_message(time)) for time in golden.world_times(world)]
    others = [(message["timestamp"], message) for message in golden.blink_messages(world) + golden.surface_messages(world)]
    return heapq.merge(pupils, gaze, others, key=lambda entry: entry[0])


MAP_ROWS, MAP_COLUMNS = 8, 10  # they fill the area "map"


def cells_seen(world):
    """Gaze samples by cell of the map, over all trials."""
    left, top, width, height = golden.AREAS["map"]
    seen = {}
    for message in golden.surface_messages(world):
        for gaze in message["gaze_on_surfaces"]:
            in_trial = any(p[0] == "trial" and p[3] <= gaze["timestamp"] < p[4] for p in world.periods)
            x, y = gaze["norm_pos"]
            if in_trial and gaze["on_surf"] and golden.area_of(x, y) == "map":
                cell = (int((1.0 - y - top) / height * MAP_ROWS), int((x - left) / width * MAP_COLUMNS))
                seen[cell] = seen.get(cell, 0) + 1
    return [[row, column, count] for (row, column), count in sorted(seen.items())]


def expected(world, samples):
    return {"periods": [{"kind": kind, "method": method, "begin": begin, "end": end} for kind, method, _, begin, end in world.periods],
            "trials": golden.expected(world, samples, world.blinks),
            "pupils": 2 * len(samples), "cells": cells_seen(world)}


class Standin:
    def __init__(self, options):
        self.options = options
        context = zmq.Context()
        self.remote = context.socket(zmq.REP)
        self.remote.bind(f"tcp://127.0.0.1:{options.port}" if options.port else "tcp://127.0.0.1:*")
        self.data = context.socket(zmq.PUB)
        self.data.sndhwm = 0
        self.port_of_data = self.data.bind_to_random_port("tcp://127.0.0.1")
        self.incoming = context.socket(zmq.SUB)
        self.incoming.setsockopt(zmq.SUBSCRIBE, b"")
        self.port_of_incoming = self.incoming.bind_to_random_port("tcp://127.0.0.1")
        self.epoch = golden.BEGIN - time.monotonic()
        self.annotates = False
        self.address = self.remote.getsockopt(zmq.LAST_ENDPOINT).decode().rstrip("\0")

    def clock(self):
        return time.monotonic() + self.epoch

    def note(self, entry):
        if self.options.log:
            with open(self.options.log, "a", encoding="utf-8") as file:
                file.write(json.dumps(entry) + "\n")

    def reply(self, frames):
        command = frames[0].decode()
        if len(frames) > 1:
            notification = msgpack.unpackb(frames[1])
            self.annotates |= notification.get("name") == "Annotation_Capture"
            self.note({"notification": notification})
            return "Message forwarded."
        if command in ("SUB_PORT", "PUB_PORT"):
            return str(self.port_of_data if command == "SUB_PORT" else self.port_of_incoming)
        if command == "t":
            return repr(self.clock())
        if command == "v":
            return "3.6.7"
        if command[:1] in ("R", "r", "C", "c"):
            self.note({"command": command})
            return "OK"
        return "Unknown command."

    def serve(self):
        poller = zmq.Poller()
        for socket in (self.remote, self.incoming):
            poller.register(socket, zmq.POLLIN)
        while True:
            ready = dict(poller.poll())
            if self.remote in ready:
                self.remote.send_string(self.reply(self.remote.recv_multipart()))
            if self.incoming in ready:
                topic, payload = self.incoming.recv_multipart()[:2]
                if topic == b"annotation" and self.annotates:  # the plugin takes them up
                    self.note({"annotation": msgpack.unpackb(payload)})

    def send(self, topic, payload):
        self.data.send_multipart([topic.encode(), payload])

    def play(self, messages):
        begin, sent = time.monotonic(), 0
        for due, message in messages:
            if self.options.speed > 0.0:
                time.sleep(max(0.0, (due - self.clock()) / self.options.speed))
            elif sent >= self.options.rate * (time.monotonic() - begin):
                time.sleep(0.002)
            self.send(message["topic"], msgpack.packb(message))
            sent += 1
        return sent


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--port", type=int, default=0, help="of Pupil Remote; 0 = any")
    parser.add_argument("--speed", type=float, default=1.0, choices=(0.0, 1.0), help="1 = the times of the recording")
    parser.add_argument("--rate", type=float, default=2500.0, help="messages a second with --speed 0")
    parser.add_argument("--scale", type=float, default=1.0, help="length of the recording, of five minutes")
    parser.add_argument("--malformed", action="store_true", help="send messages that cannot be read first")
    parser.add_argument("--expect", help="file for what conav should measure, and when what happens: JSON")
    parser.add_argument("--log", help="file for annotations, notifications and commands: JSON, one a line")
    options = parser.parse_args()
    world = golden.World(7, options.scale)
    samples = golden.eye_samples(world)
    if options.expect:
        pathlib.Path(options.expect).write_text(json.dumps(expected(world, samples)), encoding="utf-8")
    standin = Standin(options)
    threading.Thread(target=standin.serve, daemon=True).start()
    print(f"pupil remote {standin.address}", flush=True)
    if options.speed == 0.0:
        select.select([sys.stdin], [], [])
    if options.malformed:
        for payload in (b"", b"\x91" * 1000000, msgpack.packb({"id": "left"}), msgpack.packb([1])):
            standin.send("pupil.0.3d", payload)
    sent = standin.play(messages_of(world, samples))
    print(f"sent {sent} messages", flush=True)
    threading.Event().wait()


main()
