"""Many robots, operators and sites: what saturates first, from measured costs. docs/scale.md says what was found.

Attention is simulated: a robot drives for an exponential neglect time, asks, waits in the order of arrival for one of its operators, who
needs a log-normal interaction time. It drives no further while it waits. Everything else is the measured cost times its number.
"""
from __future__ import annotations

import argparse
import heapq
import json
import math
import random
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Dict, List, Tuple

from . import DataError, Error, _integer
from .leaderboard import load

COSTS = ("neglect_s", "interaction_s", "interaction_log_sd", "cores_per_robot", "decision_p99_ms", "dds_bytes_per_s_per_robot",
         "picture_bytes_per_s_per_robot", "page_bytes_per_s_per_robot", "gateway_cores_per_robot", "discovery_bytes_per_s_per_pair",
         "multicast_bytes_per_s_per_pair", "start_bytes_per_pair", "cores_per_host", "site_link_bytes_per_s", "site_network_bytes_per_s",
         "centre_link_bytes_per_s", "busy_share", "pages_per_gateway", "robots_per_system", "planners")
# What the benchmarks' --json files have: the cost and its factor.
METRICS = {"robots100_cores": ("cores_per_robot", 0.01), "robots100_decision_p99_ms": ("decision_p99_ms", 1.0),
           "operator_link_bytes_per_s_per_robot": ("dds_bytes_per_s_per_robot", 1.0),
           "operator_link_picture_bytes_per_s_per_robot": ("picture_bytes_per_s_per_robot", 1.0)}
Costs = Dict[str, float]


@dataclass
class Attention:
    """Means over time; a wait is from the question to its operator."""
    utilisation: float
    wait_s: float
    wait_p95_s: float
    driving: float  # robots that neither wait nor are attended to


def read_costs(file: Path, benches: List[Path]) -> Costs:
    """The file's {cost: [value, source]}, and instead of it what the benchmarks measured."""
    found = load(file)
    if not isinstance(found, dict):
        raise DataError(f"{file}: not a JSON object")
    costs: Costs = {}
    for key in COSTS:
        entry = found.get(key)
        value = entry[0] if isinstance(entry, list) and entry else None
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 < value < math.inf:
            raise DataError(f"{file}: {key} = {json.dumps(entry)}; expected [a number above 0, where it is from]")
        costs[key] = float(value)
    if unknown := sorted(set(found) - set(COSTS)):
        raise DataError(f"{file}: unknown: {', '.join(unknown)}")
    for bench in benches:
        results = load(bench)
        metrics = results.get("metrics", {}) if isinstance(results, dict) else {}
        used = [key for key in METRICS if isinstance(metrics.get(key), (int, float))]
        if not used:
            raise DataError(f"{bench}: metrics has none of {', '.join(METRICS)}")
        for key in used:
            cost, factor = METRICS[key]
            costs[cost] = metrics[key] * factor
    return costs


def attend(robots: int, operators: int, costs: Costs, hours: float = 4.0, seed: int = 1, exponential: bool = False) -> Attention:
    """A simulation, without its first tenth. `exponential` interaction times instead of log-normal ones with the same mean."""
    draw = random.Random(seed)
    neglect, mean, spread = costs["neglect_s"], costs["interaction_s"], costs["interaction_log_sd"]
    end, begin = hours * 3600.0, hours * 360.0
    questions = [draw.expovariate(1.0 / neglect) for _ in range(robots)]  # when each robot asks next
    free = [0.0] * operators
    heapq.heapify(questions)
    busy = stopped = 0.0
    waits: List[float] = []
    while questions[0] < end:
        asked = questions[0]
        start = max(asked, free[0])
        needed = draw.expovariate(1.0 / mean) if exponential else draw.lognormvariate(math.log(mean) - spread * spread / 2.0, spread)
        heapq.heapreplace(free, start + needed)
        heapq.heapreplace(questions, start + needed + draw.expovariate(1.0 / neglect))
        busy += max(0.0, min(end, start + needed) - max(begin, start))
        stopped += max(0.0, min(end, start + needed) - max(begin, asked))
        if asked >= begin:
            waits.append(start - asked)
    waits.sort()
    observed = end - begin
    return Attention(busy / observed / operators, sum(waits) / len(waits) if waits else 0.0,
                     waits[int(0.95 * (len(waits) - 1))] if waits else 0.0, robots - stopped / observed)


def attend_in_parts(robots: int, operators: int, parts: int, costs: Costs, hours: float) -> Attention:
    """The same for each of the parts, into which both are divided as evenly as they can be; `driving` is of all."""
    def shares(number: int) -> List[int]:
        return [(number * (part + 1)) // parts - (number * part) // parts for part in range(parts)]

    sizes = Counter(zip(shares(robots), shares(operators)))
    means = [(count / parts, attend(size, crew, costs, hours)) for (size, crew), count in sizes.items()]

    def mean(name: str) -> float:
        return sum(share * float(getattr(part, name)) for share, part in means)

    return Attention(mean("utilisation"), mean("wait_s"), mean("wait_p95_s"), mean("driving") * parts)


def predict(robots: int, operators: int, costs: Costs) -> Attention:
    """The same with exponential interaction times, in equilibrium: M/M/c//N, whose limit for many robots is Erlang's C. No 95 %."""
    ratio, weight, weights = costs["interaction_s"] / costs["neglect_s"], 0.0, [0.0]  # logarithms: N! is large
    for number in range(1, robots + 1):
        weight += math.log((robots - number + 1) * ratio / min(number, operators))
        weights.append(weight)
    highest = max(weights)
    shares = [math.exp(item - highest) for item in weights]
    total = sum(shares)
    busy = sum(min(number, operators) * share for number, share in enumerate(shares)) / total
    asking = sum(number * share for number, share in enumerate(shares)) / total
    return Attention(busy / operators, (asking - busy) * costs["interaction_s"] / busy, math.nan, robots - asking)


def operators_for(robots: int, wait_s: float, costs: Costs) -> int:
    """So many keep the mean wait at most there."""
    low, high = 1, robots
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if predict(robots, middle, costs).wait_s <= wait_s else (middle + 1, high)
    return low


def resources(operators: int, sites: int, costs: Costs) -> List[Tuple[str, Callable[[float], float]]]:
    """What can be full: its name, and its use, 1 = full, by the number of robots. A site has 6 processes besides its robots' drivers."""
    def pairs(processes: float) -> float:
        return processes * (processes - 1.0)

    def site_page(robots: float) -> float:
        return robots / sites * (max(1.0, operators / sites) * costs["page_bytes_per_s_per_robot"] + costs["picture_bytes_per_s_per_robot"])

    dds = costs["dds_bytes_per_s_per_robot"] + costs["picture_bytes_per_s_per_robot"]
    network, centre = costs["site_network_bytes_per_s"], costs["centre_link_bytes_per_s"]
    asking = costs["interaction_s"] / (costs["neglect_s"] + costs["interaction_s"])
    return [
        ("all     operators' attention", lambda n: n * asking / operators / costs["busy_share"]),
        ("sites   network of a site: discovery with peers", lambda n: pairs(n / sites + 6) * costs["discovery_bytes_per_s_per_pair"] / network),
        ("sites   network of a site: discovery with multicast", lambda n: pairs(n / sites + 6) * costs["multicast_bytes_per_s_per_pair"] / network),
        ("sites   processors of a site: one host", lambda n: n / sites * costs["cores_per_robot"] / costs["cores_per_host"]),
        ("sites   link of a site: pages", lambda n: site_page(n) / costs["site_link_bytes_per_s"]),
        ("sites   link of a site: DDS", lambda n: n / sites * dds / costs["site_link_bytes_per_s"]),
        ("sites   link of the operators: pages", lambda n: sites * site_page(n) / centre),
        ("sites   link of the operators: DDS", lambda n: n * dds / centre),
        ("sites   a core of a site's gateway", lambda n: n / sites * costs["gateway_cores_per_robot"]),
        ("one     discovery with peers", lambda n: pairs(n + costs["planners"] + 5) * costs["discovery_bytes_per_s_per_pair"] / centre),
        ("one     discovery with multicast", lambda n: pairs(n + costs["planners"] + 5) * costs["multicast_bytes_per_s_per_pair"] / centre),
        ("one     processors of all planners", lambda n: n * costs["cores_per_robot"] / costs["planners"] / costs["cores_per_host"]),
        ("one     a core of the gateway", lambda n: n * costs["gateway_cores_per_robot"]),
        ("one     pages of the gateway", lambda n: operators / costs["pages_per_gateway"]),
        ("one     robots of a system", lambda n: n / costs["robots_per_system"]),
    ]


def full_at(use: Callable[[float], float]) -> float:
    """Robots at which it is full; 0 = already without one, infinity = never."""
    low, high = 0.0, 1e6
    if use(high) < 1.0:
        return math.inf
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (low, middle) if use(middle) >= 1.0 else (middle, high)
    return low


def run(arguments: argparse.Namespace) -> int:
    robots, operators, sites = arguments.robots, arguments.operators, arguments.sites
    for name, value in (("--robots", robots), ("--operators", operators), ("--sites", sites)):
        _integer(name, value, 1)
    if not sites <= operators <= robots <= 100_000:
        raise Error(f"--sites {sites} <= --operators {operators} <= --robots {robots} <= 100000 does not hold")
    costs = read_costs(arguments.costs, arguments.bench)
    if arguments.interaction:
        costs["interaction_s"] = arguments.interaction
    print(f"{robots} robots, {operators} operators, {sites} sites; a robot asks {costs['neglect_s']:.1f} s after an answer and takes "
          f"{costs['interaction_s']:.1f} s\n\n{'robots and operators together':32}busy   wait, s   95 % under, s   robots that drive")
    results: Dict[str, Any] = {"costs": costs, "attention": {}, "resources": {}}
    for name, parts in (("all in one queue", 1), ("by site", sites), ("each operator alone", operators)):
        part = attend_in_parts(robots, operators, parts, costs, arguments.hours)
        results["attention"][name] = vars(part)
        print(f"{name:19}{robots / parts:7.4g}/{operators / parts:<5.3g}{part.utilisation:5.2f}{part.wait_s:10.1f}{part.wait_p95_s:14.1f}"
              f"{part.driving:15.0f}, {100.0 * part.driving / robots:.0f} %")
    for name, parts in (("in one queue", 1), ("by site", sites)):
        needed = parts * operators_for(robots // parts, 10.0, costs)
        results["attention"][f"operators for a mean wait of 10 s {name}"] = needed
        print(f"operators for a mean wait of 10 s, {name}: {needed}")
    print(f"\n{'layout  what':56}use    full at")
    rows = [(name, use(robots), full_at(use)) for name, use in resources(operators, sites, costs)]
    for name, used, most in sorted(rows, key=lambda row: -row[1]):
        results["resources"][" ".join(name.split())] = {"use": used, "full_at_robots": most if most < math.inf else None}
        print(f"{name:52}{100.0 * used:6.0f} %  " + ("whatever the robots" if not 1 <= most < math.inf else f"{most:.0f} robots"))
    processes = robots / sites + 6
    print(f"discovery when a site starts: {processes * (processes - 1) * costs['start_bytes_per_pair'] / 1e6:.0f} MB; decisions: 99 % under {costs['decision_p99_ms']:.0f} ms")
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=1) + "\n")
    return 0


def add_command(commands: Any) -> None:
    command = commands.add_parser("scale", help="what saturates first with many robots, operators and sites")
    command.add_argument("--costs", type=Path, required=True, help="measured costs: docs/data/scale.json")
    command.add_argument("--bench", type=Path, nargs="*", default=[], help="--json files of `conav bench fleet` and `link`, instead of the costs they measure")
    command.add_argument("--robots", type=int, default=1000)
    command.add_argument("--operators", type=int, default=50)
    command.add_argument("--sites", type=int, default=20)
    command.add_argument("--interaction", type=float, default=0.0, help="mean time with a question, seconds, instead of the costs'")
    command.add_argument("--hours", type=float, default=4.0, help="simulated")
    command.add_argument("--json", type=Path, help="also write the results to this file")
    command.set_defaults(run=run)
