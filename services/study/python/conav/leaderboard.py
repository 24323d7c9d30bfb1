"""The leaderboard: results as JSON files, checked, and printed as one table for each scenario.

A file is what `./conav experiment scenarios --json` writes, plus who made it where: docs/data/leaderboard.schema.json.
"""
from __future__ import annotations

import argparse
import json
import math
import os
import platform
import sys
from pathlib import Path
from typing import Any, Callable, Dict, List, Tuple

from . import DataError, Error, __version__

TEXTS = ("name", "conav_version", "hardware")
MEASURES: Dict[str, Tuple[float, float]] = {  # with their limits
    "steps_mean": (0.0, math.inf),
    "bytes_mean": (0.0, math.inf),
    "pictures_mean": (0.0, math.inf),
    "mapping_accuracy_mean": (0.0, 1.0),
    "goals_reached_fraction": (0.0, 1.0),
}
OF_AN_OPERATOR = ("steps", "pictures", "goals_reached_fraction")


def check(entry: Any, where: str) -> Dict[str, Any]:
    """The entry. Throws DataError that names the file, the key, the value and what is expected."""

    def refuse(key: str, value: Any, expected: str) -> Error:
        return DataError(f"{where}: {key} = {json.dumps(value)}; expected {expected}")

    if not isinstance(entry, dict):
        raise DataError(f"{where}: not a JSON object")
    for key in TEXTS:
        if not isinstance(entry.get(key), str) or not entry[key]:
            raise refuse(key, entry.get(key), "a text")
    seeds = entry.get("seeds")
    if not (isinstance(seeds, list) and len(seeds) == 2 and all(type(seed) is int for seed in seeds) and 0 <= seeds[0] <= seeds[1]):
        raise refuse("seeds", seeds, "[first, last]")
    if not isinstance(entry.get("synthetic"), bool):
        raise refuse("synthetic", entry.get("synthetic"), "true (simulated operators) or false (people)")
    scenarios = entry.get("scenarios")
    if not isinstance(scenarios, dict) or not scenarios:
        raise refuse("scenarios", scenarios, "{NAME: {METHOD: {measures}}}")
    for name, methods in scenarios.items():
        if not isinstance(methods, dict) or not methods:
            raise refuse(f"scenarios.{name}", methods, "{METHOD: {measures}}")
        for method, measures in methods.items():
            for measure, (low, high) in MEASURES.items():
                value = measures.get(measure) if isinstance(measures, dict) else None
                if isinstance(value, bool) or not isinstance(value, (int, float)) or not low <= value <= high or value == math.inf:
                    raise refuse(f"scenarios.{name}.{method}.{measure}", value, f"a number in [{low:g}, {high:g}]")
    return entry


def load(file: Path, parse_float: Callable[[str], float] = float) -> Any:
    def refuse(text: str) -> None:
        raise ValueError(f"{text} is not a number")

    try:
        return json.loads(file.read_text(), parse_float=parse_float, parse_constant=refuse)
    except ValueError as error:
        raise DataError(f"{file}: not JSON: {error}") from error


def read(file: Path) -> Dict[str, Any]:
    return check(load(file), str(file))


def table(entries: List[Dict[str, Any]]) -> str:
    """For each scenario: most goals first, then fewest steps, then fewest bytes."""
    scenarios: Dict[str, List[Tuple[Tuple[float, ...], str]]] = {}
    for entry in entries:
        for scenario, methods in entry["scenarios"].items():
            for method, measures in methods.items():
                goals, steps = measures["goals_reached_fraction"], measures["steps_mean"]
                rank = (-goals, steps, measures["bytes_mean"])
                people = "" if entry["synthetic"] else " (people)"
                line = (f"{entry['name'] + people:28} {method:22} {goals:6.3f} {steps:9.1f} {measures['bytes_mean'] / 1024:10.1f} "
                        f"{measures['pictures_mean']:9.2f} {measures['mapping_accuracy_mean']:5.2f}   "
                        f"{entry['seeds'][0]}-{entry['seeds'][1]}, conav {entry['conav_version']}")
                scenarios.setdefault(scenario, []).append((rank, line))
    head = f"{'entry':28} {'method':22} {'goals':>6} {'steps':>9} {'KiB sent':>10} {'pictures':>9} {'map':>5}   seeds, version"
    parts = [f"{scenario}\n{head}\n" + "\n".join(line for _, line in sorted(lines)) for scenario, lines in sorted(scenarios.items())]
    note = "SIMULATED operators, unless an entry says people.\n\n"
    return note + "\n\n".join(parts)


def make(sources: List[Path], name: str, seeds: str) -> Dict[str, Any]:
    """Joins results of `conav experiment scenarios --json`, made on this machine, into one entry. If several have the same method, its
    measures are those of the first; steps and pictures with each operator come from the last that has that operator."""
    first, _, last = seeds.partition("-")
    if not (first.isdecimal() and last.isdecimal() and int(first) <= int(last)):
        raise Error(f"--seeds {seeds}: expected FIRST-LAST")
    scenarios: Dict[str, Dict[str, Dict[str, Any]]] = {}
    for source in sources:
        result = load(source, lambda number: round(float(number), 4))
        if not isinstance(result, dict):
            raise DataError(f"{source}: not a JSON object")
        for scenario, methods in result.get("scenarios", {}).items():
            for method, measures in methods.items():
                if not isinstance(measures, dict):
                    continue
                made = scenarios.setdefault(scenario, {}).setdefault(method, {measure: measures.get(measure) for measure in MEASURES})
                for operator, figures in (measures.get("operators") or {}).items():
                    if not isinstance(figures, dict) or not {"steps", "pictures"} <= figures.keys():
                        raise DataError(f"{source}: scenarios.{scenario}.{method}.operators.{operator}: expected steps and pictures")
                    made.setdefault("operators", {})[operator] = {key: figures[key] for key in OF_AN_OPERATOR if key in figures}
    processor = next((line.split(":", 1)[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                      if line.startswith("model name")), platform.machine())
    return check({"name": name, "conav_version": os.environ.get("CONAV_COMMIT", __version__), "seeds": [int(first), int(last)],
                  "hardware": f"{os.cpu_count()} cores, {processor}", "synthetic": True, "scenarios": scenarios}, ", ".join(map(str, sources)))


def text_of(entry: Dict[str, Any]) -> str:
    """JSON with a line for each method."""
    def methods_text(methods: Dict[str, Any]) -> str:
        return ",\n".join(f"   {json.dumps(method)}: {json.dumps(measures)}" for method, measures in methods.items())

    head = json.dumps({key: value for key, value in entry.items() if key != "scenarios"}, indent=1)[:-2]
    scenarios = ",\n".join(f"  {json.dumps(name)}: {{\n{methods_text(methods)}}}" for name, methods in entry["scenarios"].items())
    return f'{head},\n "scenarios": {{\n{scenarios}}}\n}}'


def run(arguments: argparse.Namespace) -> int:
    if arguments.make:
        if not arguments.files:
            raise Error("--make: expected files of `conav experiment scenarios --json`")
        text = text_of(make([Path(file) for file in arguments.files], arguments.make, arguments.seeds))
        if arguments.out:
            Path(arguments.out).write_text(text + "\n")
        else:
            print(text)
        return 0
    files = [Path(file) for file in arguments.files] or sorted(Path("docs/data/results").glob("*.json"))
    if not files:
        raise Error("no results: name files, or be in a folder with docs/data/results/*.json")
    entries = [read(file) for file in files]
    if arguments.check:
        print(f"{len(files)} files are good", file=sys.stderr)
    else:
        print(table(entries))
    return 0


def add_command(commands: Any) -> None:
    command = commands.add_parser("leaderboard", help="check results and print them as a table")
    command.add_argument("files", nargs="*", help="results (docs/data/results/*.json)")
    command.add_argument("--check", action="store_true", help="only check the files")
    command.add_argument("--make", metavar="NAME", help="print the results of `conav experiment scenarios --json F` in these files as an entry called NAME")
    command.add_argument("--seeds", default="1-100", help="of --make: FIRST-LAST")
    command.add_argument("--out", metavar="FILE", help="of --make: a file instead of standard output")
    command.set_defaults(run=run)
