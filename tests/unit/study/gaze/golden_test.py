#!/usr/bin/env python3
"""golden_test.py CONAV_GAZE FOLDER: a synthetic recording in Pupil's own formats, and what it measures.

Writes a long recording as Pupil Capture does (MessagePack, from the published lists of fields, with the quirks of real ones), computes
the measures of docs/gaze.md here, in plain Python that shares nothing with conav, and compares `conav gaze` with them, for the
messages and for an export of the same data.
"""
import bisect
import csv
import json
import math
import pathlib
import random
import shutil
import statistics
import struct
import subprocess
import sys

EYE_HZ, WORLD_HZ = 120.0, 30.0
BEGIN = 100.37  # Pupil time has any epoch
UTC = 1.7e9
METHODS = {"teleop": 0.31, "instruction": 0.2, "ig-mcts": 0.17}
AREAS = {"picture": (0.05, 0.1, 0.3, 0.4), "map": (0.4, 0.1, 0.5, 0.8)}


PACKED = {  # MessagePack of the types that Pupil sends
    type(None): lambda value: b"\xc0",
    bool: lambda value: b"\xc3" if value else b"\xc2",
    int: lambda value: struct.pack(">Bq", 0xD3, value),
    float: lambda value: struct.pack(">Bd", 0xCB, value),
    str: lambda value: b"\xd9" + bytes([len(data := value.encode())]) + data,
    bytes: lambda value: b"\xc6" + struct.pack(">I", len(value)) + value,
    dict: lambda value: b"\xde" + struct.pack(">H", len(value)) + b"".join(pack(k) + pack(v) for k, v in value.items()),
    list: lambda value: b"\xdc" + struct.pack(">H", len(value)) + b"".join(map(pack, value)),
}


def pack(value):
    return PACKED[type(value)](value)


class World:
    """What happens: periods, blinks, fixations, and the true diameters of both eyes."""

    def __init__(self, seed, scale=1.0):
        """scale: of the lengths of trials and baselines."""
        self.random = random.Random(seed)
        self.periods, self.blinks, self.fixations = [], [], []
        time = BEGIN + 2.0
        for method, level in METHODS.items():
            time = self.add("baseline", method, 0.0, time, 15.0 * scale)
            for _ in range(2):
                time = self.add("trial", method, level, time, scale * (30.0 + 10.0 * self.random.random()))
        self.end = time + 1.0
        time = BEGIN + 1.0
        while time < self.end - 2.0:
            time += 1.5 + 8.0 * self.random.random()
            self.blinks.append((time, time + 0.12 + 0.1 * self.random.random()))
        time, number = BEGIN + 0.5, 0
        while time < self.end - 1.0:
            duration = 0.1 + 0.4 * self.random.random()
            self.fixations.append((number, time, duration, self.random.random(), self.random.random()))
            time, number = time + duration + 0.05, number + 1

    def add(self, kind, method, level, time, duration):
        self.periods.append((kind, method, level, time, time + duration))
        return time + duration + 1.0

    def diameter(self, eye, time):
        level = next((p[2] for p in self.periods if p[3] <= time < p[4]), 0.0)
        base = 3.5 if eye == 0 else 3.9
        return base * (1.0 + level) + 0.08 * math.sin(1.7 * time + eye) + self.random.gauss(0.0, 0.01)

    def blinking(self, time):
        return any(b - 0.01 <= time <= e + 0.01 for b, e in self.blinks)


def eye_samples(world):
    samples = []
    count = int((world.end - BEGIN) * EYE_HZ)
    for eye in (0, 1):
        for i in range(count):
            time = BEGIN + (i + 0.3 * world.random.random()) / EYE_HZ + 0.002 * eye
            confidence, diameter = 0.9 + 0.1 * world.random.random(), world.diameter(eye, time)
            if world.blinking(time):
                confidence, diameter = 0.2, diameter * 0.6
            elif world.random.random() < 0.002:
                diameter = 15.0 + 15.0 * world.random.random()  # with good confidence, as users report
            elif world.random.random() < 0.001:
                diameter *= 1.5  # in range, but too fast
            if eye == 1 and BEGIN + 60.0 < time < BEGIN + 64.0:
                confidence = 0.1  # one eye is lost for a while
            samples.append((time, eye, confidence, diameter))
    return sorted(samples)


# --- What is expected ---------------------------------------------------------------------------


def clean(samples, eye, blinks):
    mine = [(t, d) for t, e, c, d in samples if e == eye and c >= 0.6 and 1.5 <= d <= 9.0]
    slopes = [abs(b[1] - a[1]) / (b[0] - a[0]) for a, b in zip(mine, mine[1:])]
    speeds = [max(pair) for pair in zip([0.0] + slopes, slopes + [0.0])]
    middle = statistics.median(speeds)
    limit = middle + 16.0 * statistics.median(abs(s - middle) for s in speeds)
    mine = [sample for sample, speed in zip(mine, speeds) if speed <= limit]
    holes = [(a[0], b[0]) for a, b in zip(mine, mine[1:]) if b[0] - a[0] > 0.075]
    mine = [(t, d) for t, d in mine if not any(a - 0.05 <= t <= b + 0.05 for a, b in holes)]
    return [(t, d) for t, d in mine if not any(a <= t <= b for a, b in blinks)]


def on_grid(cleaned, begin, end):
    times, values, grid = [t for t, _ in cleaned], [d for _, d in cleaned], []
    for i in range(int((end - begin) * 60.0) + 1):
        time = begin + i / 60.0
        right = bisect.bisect_left(times, time)
        value = None
        if 0 < right < len(times) and times[right] - times[right - 1] <= 0.25:
            share = (time - times[right - 1]) / (times[right] - times[right - 1])
            value = values[right - 1] + share * (values[right] - values[right - 1])
        grid.append((time, value))
    return grid


def area_of(x, y):
    for name, (left, top, width, height) in AREAS.items():
        if left <= x < left + width and top <= 1.0 - y < top + height:
            return name
    return None


def expected(world, samples, blinks):
    begin, end = samples[0][0], samples[-1][0]
    grids = [on_grid(clean(samples, eye, blinks), begin, end) for eye in (0, 1)]
    rows, bases = [], None
    for kind, method, _, first, last in world.periods:
        inside = [[v for t, v in grid if first <= t < last] for grid in grids]
        if kind == "baseline":
            bases = [statistics.fmean(v for v in values if v is not None) for values in inside]
            continue
        pcpd = []
        for pair in zip(*inside):
            shares = [100.0 * (v - b) / b for v, b in zip(pair, bases) if v is not None]
            pcpd.append(statistics.fmean(shares) if shares else None)
        present = [p for p in pcpd if p is not None]
        minutes = (last - first) / 60.0
        seen = [(area_of(x, y), d) for _, t, d, x, y in world.fixations if first <= t < last]
        seen = [(name, d) for name, d in seen if name]
        rows.append({
            "method": method,
            "valid_share": len(present) / len(pcpd),
            "pcpd_mean": statistics.fmean(present),
            "pcpd_sd": statistics.stdev(present),
            "blinks_per_min": sum(first <= b < last for b, _ in blinks) / minutes,
            "shifts_per_min": sum(a[0] != b[0] for a, b in zip(seen, seen[1:])) / minutes,
            "picture": sum(name == "picture" for name, _ in seen) / minutes,
        })
    return rows


# --- Pupil's files ------------------------------------------------------------------------------


def pupil_message(time, eye, confidence, diameter, method):
    message = {"id": eye, "topic": f"pupil.{eye}.{method}", "method": "pye3d 0.3.0 real-time" if method == "3d" else "2d c++",
               "norm_pos": [0.5, 0.5], "diameter": diameter * 11.0, "timestamp": time, "confidence": confidence,
               "ellipse": {"center": [96.0, 96.0], "axes": [30.0, 33.0], "angle": 12.0}}
    if method == "3d":
        message |= {"diameter_3d": diameter, "model_confidence": 1.0, "theta": 1.5, "phi": -1.5,
                    "circle_3d": {"center": [0.0, 1.0, 30.0], "normal": [0.0, 0.0, -1.0], "radius": diameter / 2.0}}
    return message


def gaze_message(time):
    return {"topic": "gaze.3d.01.", "norm_pos": [0.5, 0.5], "confidence": 0.9, "timestamp": time,
            "gaze_normals_3d": {"0": [0.0, 0.0, 1.0], "1": [0.0, 0.0, 1.0]}, "base_data": []}


def world_times(world):
    return [BEGIN + i / WORLD_HZ for i in range(int((world.end - BEGIN) * WORLD_HZ))]


def blink_messages(world):
    """An onset while the lids close and an offset while they open, each with every frame of the world camera."""
    messages = []
    for begin, end in world.blinks:
        middle = 0.5 * (begin + end)
        for time in [begin] + [t for t in world_times(world) if begin < t < end] + [end]:
            messages.append({"topic": "blinks", "type": "onset" if time < middle else "offset", "confidence": 0.7, "timestamp": time,
                             "base_data": [pupil_message(time, 0, 0.2, 3.0, "2d")], "record": True})
    return messages


def surface_messages(world):
    messages, begins = [], [f[1] for f in world.fixations]
    for time in world_times(world):
        index = bisect.bisect_right(begins, time) - 1
        fixations, gaze = [], []
        if index >= 0:
            number, begin, duration, x, y = world.fixations[index]
            # The fixation grows with each frame; once it is over, its whole duration stands.
            so_far = duration if time >= begin + duration else max(time - begin, 0.01)
            fixations.append({"topic": "fixations_on_surface", "norm_pos": [x, y], "confidence": 0.9, "on_surf": True, "id": number,
                              "base_data": ["fixations", begin], "timestamp": begin, "duration": 1000.0 * so_far, "dispersion": 1.0})
            gaze.append({"topic": "gaze.3d.01._on_surface", "norm_pos": [x, y], "confidence": 0.9, "on_surf": True,
                         "base_data": ["gaze.3d.01.", time], "timestamp": time})
            gaze.append({"topic": "gaze.3d.01._on_surface", "norm_pos": [1.4, 0.5], "confidence": 0.9, "on_surf": False,
                         "base_data": ["gaze.3d.01.", time], "timestamp": time})
        messages.append({"topic": "surfaces.page", "name": "page", "timestamp": time, "surf_to_img_trans": [[1.0, 0.0, 0.0]] * 3,
                         "gaze_on_surfaces": gaze, "fixations_on_surfaces": fixations})
    return messages


def write_capture(folder, world, samples):
    folder.mkdir(parents=True)
    info = {"duration_s": world.end - BEGIN, "meta_version": "2.3", "min_player_version": "2.0", "recording_name": "P01",
            "recording_software_name": "Pupil Capture", "start_time_synced_s": BEGIN, "start_time_system_s": UTC, "recording_uuid": "0"}
    (folder / "info.player.json").write_text(json.dumps(info))
    messages = {"pupil": [], "gaze": [], "annotation": []}
    for time, eye, confidence, diameter in samples:
        for method in ("2d", "3d"):
            messages["pupil"].append(pupil_message(time, eye, confidence, diameter, method))
    for time in world_times(world):
        messages["gaze"].append(gaze_message(time))
    for kind, method, _, first, last in world.periods:
        for what, time in (("begin", first), ("end", last)):
            messages["annotation"].append({"topic": "annotation", "label": f"{kind} {what}", "timestamp": time, "duration": 0.0,
                                           "method": method, "participant": "P01"})
    messages |= {"blinks": blink_messages(world), "surfaces": surface_messages(world)}
    for name, all_of in messages.items():
        with open(folder / f"{name}.pldata", "wb") as file:
            for message in all_of:
                file.write(b"\x92" + pack(message["topic"]) + pack(pack(message)))


def write_rows(path, header, rows):
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([header, *rows])


def write_export(folder, world, samples):
    header = ["pupil_timestamp", "world_index", "eye_id", "confidence", "norm_pos_x", "norm_pos_y", "diameter", "method", "diameter_3d"]
    rows = []
    for time, eye, confidence, diameter in samples:
        rows.append([time, 0, eye, confidence, 0.5, 0.5, diameter * 11.0, "2d c++", ""])
        rows.append([time, 0, eye, confidence, 0.5, 0.5, diameter * 11.0, "pye3d 0.3.0 real-time", diameter])
    write_rows(folder / "pupil_positions.csv", header, rows)
    header = ["id", "start_timestamp", "duration", "end_timestamp", "start_frame_index", "index", "end_frame_index", "confidence",
              "filter_response", "base_data"]
    write_rows(folder / "blinks.csv", header, [[i, b, e - b, e, 0, 0, 0, 0.7, "0.1 0.2", "1 2"] for i, (b, e) in enumerate(world.blinks)])
    header = ["world_timestamp", "world_index", "fixation_id", "start_timestamp", "duration", "dispersion", "norm_pos_x", "norm_pos_y",
              "x_scaled", "y_scaled", "on_surf"]
    rows = [[t, frame, i, t, 1000.0 * d, 1.0, x, y, x, y, "True"] for i, t, d, x, y in world.fixations for frame in (0, 1, 2)]
    write_rows(folder / "surfaces" / "fixations_on_surface_page.csv", header, rows)


def compare(name, got, wanted, tolerance=1e-6):
    assert len(got) == len(wanted), f"{name}: {len(got)} trials instead of {len(wanted)}"
    for trial, row in zip(got, wanted):
        for key, value in row.items():
            found = trial["fixations_per_min"]["picture"] if key == "picture" else trial[key]
            close = found == value if isinstance(value, str) else math.isclose(found, value, rel_tol=tolerance, abs_tol=tolerance)
            assert close, f"{name}, {row['method']}: {key} is {found} instead of {value}"


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(folder, ignore_errors=True)
    world = World(7)
    samples = eye_samples(world)
    wanted = expected(world, samples, world.blinks)
    areas = folder / "areas.csv"
    write_rows(areas, ["utc_s", "area", "x", "y", "width", "height"], [[UTC - 10.0, name, *box] for name, box in AREAS.items()])

    def run(name, recording):
        result = folder / f"{name}.json"
        subprocess.run([program, recording, "--areas", areas, "--out", folder / name, "--json", result], check=True, stdout=subprocess.DEVNULL)
        compare(name, json.loads(result.read_text())["trials"], wanted)

    write_capture(folder / "000", world, samples)
    run("messages", folder / "000")
    write_export(folder / "000" / "exports" / "000", world, samples)
    run("export", folder / "000")
    print(f"{len(wanted)} trials of {len(samples)} samples, as messages and as an export: " +
          ", ".join(f"{row['method']} {row['pcpd_mean']:.2f} %" for row in wanted))


if __name__ == "__main__":
    main()
