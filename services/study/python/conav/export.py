"""Data sets for other tools: segments and episodes as NPZ (or Parquet, where pyarrow is installed) with a data card."""
from __future__ import annotations

import argparse
import importlib
import json
import subprocess
import sys
from pathlib import Path
from typing import Any, Dict, Iterable, List, Tuple

import numpy as np

from . import ConavEnv, DataError, Error, __version__, _conav, _integer, operator_kinds
from .environment import WAIT

Columns = Dict[str, np.ndarray]

SEGMENT_FIELDS = {
    "trajectory": "number of the trajectory; those of one person in one maze belong together",
    "split": "train, validation or test, of whole trajectories: by a hash of the world's seeds, participant and session",
    "step": "rises within a trajectory",
    "origin": "person, simulated (the operator of a run) or synthetic (conav dataset synthesize)",
    "rows, columns": "size of the maps; smaller ones are padded with 255",
    "x": "the operator's map before, 1 wall",
    "x_next": "the operator's map after",
    "o_free, o_wall": "cells that the picture shows free, or as walls",
    "tau": "the last place of the cell on the robot's path since the picture before, from 1, at most 254; 0 off the path",
    "pose": "row, column and heading (degrees, 0 east, counter-clockwise) of the camera",
}
EPISODE_FIELDS = {
    "episode, seed": "number of the episode, and the seed that plays it again",
    "action": "0 to 3 a move north, east, south, west; 4 to 11 a picture towards 0, 45, ... degrees; 12 wait",
    "reward, terminated": "of conav.ConavEnv's default reward",
    "map": "what the robot has seen: 0 unknown, 1 free, 2 wall",
    "belief": "the operator's map: probability of a wall",
    "guidance, goals, path, robots": "1 on the operator's path, goals left, cells since the last picture, other robots",
    "picture": "the newest picture as cells: 0 not shown, 1 free, 2 wall",
    "pose": "row, column, heading (radians)",
    "action_mask": "1 where an action may do something",
}


def read_segments(lines: Iterable[str]) -> Tuple[Columns, List[str]]:
    """The JSON lines of `conav dataset export` as arrays, one row a segment, and the origins among them."""
    rows: List[Dict[str, Any]] = []
    trajectory: Dict[str, Any] = {}
    number = -1
    for at, line in enumerate(lines, 1):
        try:
            record = json.loads(line)
            if record["type"] == "trajectory":
                trajectory, number = record, number + 1
            else:
                rows.append({**record, "trajectory": number, "of": trajectory})
        except (ValueError, KeyError, TypeError) as error:
            raise DataError(f"line {at}: not a line of segments ({error})") from error
    if not rows:
        raise DataError("no segments")
    height = max(row["of"]["rows"] for row in rows)
    width = max(row["of"]["columns"] for row in rows)
    maps: Columns = {name: np.full((len(rows), height, width), 255, np.uint8)
                     for name in ("x", "x_next", "o_free", "o_wall", "tau")}
    for i, row in enumerate(rows):
        shape = (row["of"]["rows"], row["of"]["columns"])
        for name in ("x", "x_next", "o_free", "o_wall"):
            maps[name][i, :shape[0], :shape[1]] = np.frombuffer(row[name].encode(), np.uint8).reshape(shape) - ord("0")
        maps["tau"][i, :shape[0], :shape[1]] = 0
        for index, (r, c) in enumerate(row["tau"]):
            maps["tau"][i, r, c] = min(index + 1, 254)
    poses = [[row["pose"]["r"], row["pose"]["c"], row["pose"]["heading_deg"]] for row in rows]
    columns: Columns = {
        "trajectory": np.array([row["trajectory"] for row in rows], np.int32),
        "split": np.array([split_of(row["of"]) for row in rows]),
        "step": np.array([row["step"] for row in rows], np.int32),
        "origin": np.array([row["of"]["origin"] for row in rows]),
        "rows": np.array([row["of"]["rows"] for row in rows], np.int32),
        "columns": np.array([row["of"]["columns"] for row in rows], np.int32),
        **maps,
        "pose": np.array(poses, np.float32),
    }
    return columns, sorted(set(columns["origin"].tolist()))


def split_of(trajectory: Dict[str, Any]) -> str:
    """80 % train, 10 % validation, 10 % test."""
    keys = ("world_seed", "corruption_seed", "participant", "session", "annotator_seed")
    seed = 0
    for character in "/".join(str(trajectory.get(key, "")) for key in keys).encode():
        seed = _conav.derive_seed(seed, character)
    return ("test", "validation")[seed % 10] if seed % 10 < 2 else "train"


def play_episodes(count: int, first_seed: int, method: str, operator: str) -> Columns:
    """Every step of episodes by a method, or by random legal actions."""
    steps: List[Dict[str, Any]] = []
    env = ConavEnv(operator)
    for seed in range(first_seed, first_seed + count):
        observation, info = env.reset(seed=seed)
        env.action_space.seed(seed)
        decider = None if method == "random" else env.method(method)
        ended = False
        while not ended:
            action = env.action_space.sample(info["action_mask"]) if decider is None else env.decide(decider)
            step = {**observation, "action_mask": info["action_mask"], "episode": seed - first_seed, "seed": seed, "action": action}
            observation, reward, terminated, truncated, info = env.step(action)
            ended = terminated or truncated or (decider is not None and action == WAIT)
            steps.append({**step, "reward": np.float32(reward), "terminated": terminated})
    return {key: np.array([step[key] for step in steps]) for key in steps[0]}


def write(file: Path, columns: Columns) -> None:
    """NPZ or Parquet, by the file's name."""
    if file.suffix == ".npz":
        np.savez_compressed(file, **columns)
    else:
        try:
            pyarrow = importlib.import_module("pyarrow")
            parquet = importlib.import_module("pyarrow.parquet")
        except ImportError:
            raise Error(f"{file}: Parquet needs pyarrow, which Debian 12 does not have; write .npz, or install pyarrow") from None
        # A map is a list of its values, row-major; rows and columns give its shape.
        flat = {name: list(array.reshape(len(array), -1)) if array.ndim > 1 else array for name, array in columns.items()}
        parquet.write_table(pyarrow.table(flat), str(file))


def card(title: str, origins: List[str], source: str, columns: Columns, fields: Dict[str, str], splits: str) -> str:
    """The data card: Markdown with the front matter of data set hubs."""
    people = "Made by people." if origins == ["person"] else (
        "NOT about people: the operators are SIMULATED." if "person" not in origins else
        "Partly made by people, partly by SIMULATED operators: see `origin`.")
    lines = [f"| `{name}` | {text} |" for name, text in fields.items()]
    shapes = [f"| `{name}` | {array.dtype} | {' x '.join(map(str, array.shape))} |" for name, array in columns.items()]
    return "\n".join([
        "---", "license: apache-2.0", f'pretty_name: "{title}"', f"synthetic: {str('person' not in origins).lower()}", "---",
        f"# {title}", "", people, "", f"- **Origin**: {', '.join(origins)}; made by conav {__version__}: `{source}`",
        "- **License**: Apache-2.0, as conav. Data of people that you recorded are yours: change this line.",
        f"- **Splits**: {splits}", "", "| field | meaning |", "| --- | --- |", *lines, "", "| array | type | shape |",
        "| --- | --- | --- |", *shapes, ""])


def check_name(file: Path) -> None:
    """Before any work."""
    if file.suffix not in (".npz", ".parquet"):
        raise Error(f"{file}: expected a name that ends in .npz or .parquet")
    if not file.parent.is_dir():
        raise Error(f"{file.parent}: no such folder")


def run_segments(arguments: argparse.Namespace) -> int:
    check_name(Path(arguments.out))
    if arguments.file.endswith(".jsonl"):
        lines = Path(arguments.file).read_text().splitlines()
    else:
        program = Path(arguments.conav) if arguments.conav else Path(__file__).parents[2] / "bin" / "conav-dataset"
        if not program.exists():
            raise Error(f"{program}: not there; build it with ./conav dataset --help, or give a .jsonl of `conav dataset export`")
        done = subprocess.run([str(program), "export", arguments.file], capture_output=True, text=True)
        if done.returncode != 0:
            raise (Error if done.returncode == 2 else DataError)(done.stderr.strip())
        lines = done.stdout.splitlines()
    columns, origins = read_segments(lines)
    counts = {name: int((columns["split"] == name).sum()) for name in ("train", "validation", "test")}
    splits = ", ".join(f"{name} {count}" for name, count in counts.items()) + " segments, by trajectory"
    finish(arguments, columns, "Segments: how operators edit a map after a picture", origins,
           f"conav export segments {Path(arguments.file).name}", SEGMENT_FIELDS, splits)
    return 0


def run_episodes(arguments: argparse.Namespace) -> int:
    check_name(Path(arguments.out))
    _integer("--episodes", arguments.episodes, 1)
    columns = play_episodes(arguments.episodes, arguments.first_seed, arguments.method, arguments.operator)
    source = (f"conav export episodes --episodes {arguments.episodes} --first-seed {arguments.first_seed} "
              f"--method {arguments.method} --operator {arguments.operator}")
    finish(arguments, columns, "Episodes: a robot, a wrong map and an operator", ["simulated"], source, EPISODE_FIELDS,
           "none; episodes of different seeds are independent, so split by seed")
    return 0


def finish(arguments: argparse.Namespace, columns: Columns, title: str, origins: List[str], source: str,
           fields: Dict[str, str], splits: str) -> None:
    file = Path(arguments.out)
    write(file, columns)
    file.with_suffix(".md").write_text(card(title, origins, source, columns, fields, splits))
    print(f"{file}: {len(next(iter(columns.values())))} rows; {file.with_suffix('.md')}: the data card", file=sys.stderr)


def add_command(commands: Any) -> None:
    command = commands.add_parser("export", help="write segments or episodes as NPZ or Parquet, with a data card")
    kinds = command.add_subparsers(metavar="segments|episodes", required=True)
    segments = kinds.add_parser("segments", help="a segment file, or the JSON lines of `conav dataset export`")
    segments.add_argument("file", help="FILE.pb.zst or FILE.jsonl")
    segments.add_argument("--conav", help="the program conav-dataset (that of this build)")
    segments.set_defaults(run=run_segments)
    episodes = kinds.add_parser("episodes", help="episodes with a SIMULATED operator, step by step")
    episodes.add_argument("--episodes", type=int, default=100)
    episodes.add_argument("--first-seed", type=int, default=1)
    episodes.add_argument("--method", default="ig-mcts", choices=["ig-mcts", "instruction", "greedy", "random"])
    episodes.add_argument("--operator", default="careful", choices=operator_kinds())
    episodes.set_defaults(run=run_episodes)
    for kind in (segments, episodes):
        kind.add_argument("--out", required=True, help="F.npz or F.parquet; the card is F.md")
