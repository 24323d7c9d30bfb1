"""conav from Python: worlds, SIMULATED operators, perception models, the search, and episodes as environments.

A cell is a tuple (row, column), row 0 north. A map is an array uint8 of UNKNOWN, FREE and WALL, a belief an array float32
of the probability that the operator takes a cell for a wall. Headings are radians, 0 east, counter-clockwise. Errors are
conav.Error, a ValueError, with the text that the C++ programs print. docs/python.md has examples.
"""
from __future__ import annotations

import math
import sys
from operator import index as _index
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union

try:
    import numpy  # noqa: F401
    from . import _conav
except ImportError as error:
    _WHY = f"conav: {error}; it runs with Debian 12's /usr/bin/python3 and python3-numpy (apt install python3-numpy), not {sys.executable}"
    if sys.argv[:1] == ["-m"]:  # python3 -m conav
        sys.exit(_WHY)
    raise ImportError(_WHY) from error
from ._conav import (Decision, Episode, Error, Model, Problem, Reaction, RootAction, View, World, cast_range, cast_view,
                     derive_seed, mapping_accuracy, maze_presets, operator_kinds)

__all__ = [
    "ConavEnv", "DataError", "Decision", "Episode", "Error", "FREE", "Method", "Model", "Operator", "ParallelConavEnv", "Problem",
    "Reaction", "RootAction", "Scenario", "UNKNOWN", "View", "WALL", "World", "cast_range", "cast_view", "decide", "derive_seed",
    "encoder_decoder", "glpf", "mapping_accuracy", "maze_presets", "nhpm", "operator_kinds",
    "run_experiment",
]
__version__ = "0.2.0"

UNKNOWN, FREE, WALL = 0, 1, 2

_FOLDER = Path(__file__).parent


class DataError(Error):
    """A file has another format."""


def _integer(name: str, value: Any, low: int, high: int = 2**31 - 1) -> int:
    """The value. Throws Error that names it, as the next three do."""
    try:
        number = _index(value)
    except TypeError:
        number = low - 1
    if not low <= number <= high:
        raise Error(f"{name} = {value!r}; expected an integer in [{low}, {high}]")
    return number


def _seed(name: str, value: Any) -> int:
    return _integer(name, value, 0, 2**64 - 1)


def _number(name: str, value: Any) -> float:
    try:
        if math.isfinite(value):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise Error(f"{name} = {value!r}; expected a finite number")


def _keys(name: str, value: Optional[Mapping[str, Any]], known: Optional[Sequence[str]] = None) -> Dict[str, Any]:
    """A dict of the value, in which None has no keys."""
    if value is not None and not isinstance(value, Mapping):
        raise Error(f"{name} = {value!r}; expected a dict")
    for key in value or {}:
        if known is not None and key not in known:
            raise Error(f"{name}: unknown key {key!r}; known keys: {', '.join(known)}")
    return dict(value or {})


def nhpm(weights: Union[str, Path, None] = None) -> Model:
    """The network for mazes; without `weights` the one that comes with conav."""
    return _conav.load_model("nhpm", str(weights or _FOLDER / "models" / "default.nhpm"))


def encoder_decoder(weights: Union[str, Path, None] = None) -> Model:
    """The network for rasters of any size."""
    return _conav.load_model("encoder-decoder", str(weights or _FOLDER / "models" / "encoder-decoder.nhpm"))


def glpf(**parameters: Any) -> Model:
    """The grid-based logistic psychometric function: alpha_d, alpha_m, beta, rho, lambda, visible_only, tie_alphas."""
    return _conav.load_model("glpf", "", parameters)


class Method(_conav.Method):
    """What decides for one robot during one episode: "ig-mcts", "instruction" or "greedy".

    `search` is the name of a preset or a dict of keys of planner.search, `communication` one of keys of
    planner.communication (docs/configuration.md). `model` predicts the operator's edits; None is nhpm().
    """

    def __init__(self, name: str = "ig-mcts", search: Union[str, Mapping[str, Any]] = "default",
                 communication: Optional[Mapping[str, Any]] = None, model: Optional[Model] = None, seed: int = 1,
                 x_source: str = "observed") -> None:
        keys = {"preset": search} if isinstance(search, str) else _keys("search", search)
        if model is None and name == "ig-mcts":
            model = nhpm()
        super().__init__(name, keys, _keys("communication", communication), model, _seed("seed", seed), x_source)


def decide(problem: Problem, method: str = "ig-mcts", **arguments: Any) -> Decision:
    """One decision by a new Method(method, **arguments), with the statistics of the search's root."""
    return Method(method, **arguments).decide(problem)


class Operator(_conav.Operator):
    """A SIMULATED person with one robot: `kind` is one of operator_kinds(), `parameters` change keys of it
    (docs/configuration.md, simulated_operator)."""

    def __init__(self, kind: str = "careful", seed: int = 1, **parameters: Any) -> None:
        super().__init__({"kind": kind, **parameters}, _seed("seed", seed))


class Scenario(_conav.Scenario):
    """A task of deploy/config/scenarios.yaml by name; `changes` are keys of that file: preset, robots,
    corruption={"wrong_share": 0.25}, goal_knowledge, marked_goals, ..."""

    def __init__(self, name: str = "paper", **changes: Any) -> None:
        super().__init__(name, str(_FOLDER / "config" / "scenarios.yaml"), changes)

    def world(self, seed: int) -> World:
        """The world of `conav experiment` with that seed."""
        return _conav.scenario_world(self, _seed("seed", seed))


def run_experiment(scenario: Union[str, Scenario] = "paper", variant: Optional[Mapping[str, Any]] = None,
                   operators: Sequence[str] = ("careful",), first_seed: int = 1001, seeds: int = 1,
                   model: Optional[Model] = None, threads: int = 1) -> List[Dict[str, Any]]:
    """Whole episodes by the planner of the services, with right of way between robots: those of `conav experiment`.

    `variant` has keys of deploy/config/search_variants.yaml. A dict for each operator and seed: counts and trajectory.
    """
    if isinstance(scenario, str):
        scenario = Scenario(scenario)
    return _conav.run_experiment(scenario, _keys("variant", variant), operators, _seed("first_seed", first_seed),
                                 _integer("seeds", seeds, 1), model or nhpm(), _integer("threads", threads, 1, 256))


from .environment import ConavEnv, ParallelConavEnv  # noqa: E402  (they use the names above)
