"""python3 -m conav: what there is, and the commands of the package."""
from __future__ import annotations

import argparse
import signal
import sys
import time

from . import ConavEnv, DataError, Error, __version__, _integer, export, leaderboard, maze_presets, operator_kinds, reproduce, scale

OVERVIEW = f"""conav {__version__}: robots, wrong maps, and SIMULATED operators who correct them.

  World(seed=7)                    truth, human_map, starts, goals; presets: {", ".join(maze_presets())}
  nhpm(), glpf(alpha_d=0.2)        predict(belief, path, view) -> (p_add, p_remove)
  cast_view(map, cell, heading_rad), cast_range(truth, cell)
  decide(Problem(...))             one decision of IG-MCTS with the statistics of its root
  Operator("careful")              reacts to pictures with edits and a path; {", ".join(operator_kinds())}
  ConavEnv(), ParallelConavEnv(4)  episodes with the interfaces of Gymnasium and PettingZoo

Example:
  import conav
  env = conav.ConavEnv("careful")
  observation, info = env.reset(seed=7)
  print(env.render())
  print(env.play(env.method("ig-mcts")))      # the episode of `conav experiment search`, seed 7

Commands: python3 -m conav {{play,bench,export,leaderboard,reproduce,scale}} --help; docs/python.md says more."""


def bench(arguments: argparse.Namespace) -> int:
    """Steps with random legal actions, observations included."""
    _integer("--steps", arguments.steps, 1)
    env = ConavEnv()
    _, info = env.reset(seed=arguments.seed)
    env.action_space.seed(arguments.seed)
    start = time.process_time()
    for _ in range(arguments.steps):
        _, _, terminated, truncated, info = env.step(env.action_space.sample(info["action_mask"]))
        if terminated or truncated:
            _, info = env.reset()
    seconds = time.process_time() - start
    print(f"{arguments.steps} steps with random actions in {seconds:.2f} s of one core: {arguments.steps / seconds:.0f} steps/s")
    return 0


def play(arguments: argparse.Namespace) -> int:
    """One episode by a method."""
    env = ConavEnv(arguments.operator)
    env.reset(seed=arguments.seed)
    options = {"search": arguments.search} if arguments.method == "ig-mcts" else {}
    for key, value in env.play(env.method(arguments.method, **options)).items():
        if key != "trajectory":
            print(f"{key:18} {value}")
    return 0


def main() -> int:
    """Exit codes: 1 it failed, or data have another format; 2 wrong use, and a named file that cannot be opened."""
    parser = argparse.ArgumentParser(prog="python3 -m conav", epilog=OVERVIEW,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(metavar="COMMAND")
    command = commands.add_parser("play", help="play an episode with a SIMULATED operator by a method")
    command.add_argument("--seed", type=int, default=7)
    command.add_argument("--method", default="ig-mcts", choices=["ig-mcts", "instruction", "greedy"])
    command.add_argument("--search", default="default", help="preset of ig-mcts")
    command.add_argument("--operator", default="careful", choices=operator_kinds())
    command.set_defaults(run=play)
    command = commands.add_parser("bench", help="measure environment steps per second")
    command.add_argument("--steps", type=int, default=20000)
    command.add_argument("--seed", type=int, default=1)
    command.set_defaults(run=bench)
    export.add_command(commands)
    leaderboard.add_command(commands)
    reproduce.add_command(commands)
    scale.add_command(commands)
    arguments = parser.parse_args()
    if "run" not in arguments:
        print(OVERVIEW)
        return 0
    try:
        return int(arguments.run(arguments))
    except OSError as error:
        text, code = (f"{error.filename}: {error.strerror}", 2) if error.filename else (str(error), 1)
    except Error as error:
        text, code = str(error), 1 if isinstance(error, DataError) else 2
    print(f"conav: {text}", file=sys.stderr)
    return code


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # of `| head`
    sys.exit(main())
