"""Episodes with the interfaces of Gymnasium (ConavEnv) and of PettingZoo's parallel environments (ParallelConavEnv).

Neither package is needed; where gymnasium can be imported, the spaces are gymnasium's. An episode has the rules of
`conav experiment`: no physics, a SIMULATED operator who answers a picture at once. Seed S gives the maze, the operator and
the method's random numbers of that program's seed S.
"""
from __future__ import annotations

import importlib
import math
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _conav, _integer, _keys, _number, _seed
from . import spaces as own_spaces

# The actions: moves, pictures towards eight headings (0 east, counter-clockwise), and to wait.
MOVES = ((-1, 0), (0, 1), (1, 0), (0, -1))  # north, east, south, west
VIEWS = 8
WAIT = len(MOVES) + VIEWS
ACTION_NAMES = ["north", "east", "south", "west"] + [f"picture {360 * i // VIEWS} deg" for i in range(VIEWS)] + ["wait"]

# The search's own numbers (services/planner/search/reward.h): r_g for an action that reaches a goal, and the price of
# any other; what a picture is worth is left to the user.
REWARD = {"goal": 100.0, "step": -1.0, "picture": -0.25, "blocked": -1.0}

Observation = Dict[str, np.ndarray]
Result = Dict[str, Any]


def _spaces() -> Any:
    try:
        return importlib.import_module("gymnasium.spaces")
    except ImportError:
        return own_spaces


class _Episodes:
    """What both environments are made of.

    operator: one of conav.operator_kinds(), or a dict of keys of the simulated operator. scenario: a conav.Scenario or the
    name of one; `changes` are keys of it (preset="15x15", observation_distance_cells=1, marked_goals=True, ...).
    streams: each move streams pictures. pixels: (height, width) of pictures as the robot's camera shows them, rendered by
    MuJoCo, which needs EGL; such an environment stays on one thread. action_limit: moves and pictures per robot; 600, more in larger mazes.
    """

    def __init__(self, operator: Union[str, Mapping[str, Any]] = "careful", scenario: Union[str, _conav.Scenario] = "paper", *,
                 action_limit: Optional[int] = None, reward: Optional[Mapping[str, float]] = None, streams: bool = False,
                 pixels: Optional[Tuple[int, int]] = None, **changes: Any) -> None:
        from . import Scenario
        if not isinstance(scenario, str) and changes:
            raise _conav.Error("changes go with the name of a scenario")
        self.scenario = Scenario(scenario, **changes) if isinstance(scenario, str) else scenario
        self._operator = {"kind": operator} if isinstance(operator, str) else _keys("operator", operator)
        changed = _keys("reward", reward, list(REWARD))
        self._reward = {**REWARD, **{key: _number(f"reward[{key!r}]", value) for key, value in changed.items()}}
        self._streams = streams
        self._pixels = pixels
        self._seeds = np.random.default_rng()
        world = _conav.scenario_world(self.scenario, 1)
        limit = int(600 * max(1.0, world.truth.size / 13**2)) if action_limit is None else action_limit
        self._action_limit = _integer("action_limit", limit, 1)
        self._start(1, world)

    def _start(self, seed: int, world: _conav.World) -> None:
        self.episode = _conav.Episode(world, self._operator, seed, self.scenario, self._streams, self._pixels)
        self.world = world
        self._seed = seed
        self._actions = 0

    def _reset(self, seed: Optional[int], options: Optional[Mapping[str, Any]]) -> None:
        world = _keys("options", options, ["world"]).get("world")
        if seed is not None:
            seed = _seed("seed", seed)
            self._seeds = np.random.default_rng(seed)
        else:
            seed = int(self._seeds.integers(1, 2**31))
        self._start(seed, world if world is not None else _conav.scenario_world(self.scenario, seed))

    def _step(self, actions: Sequence[Any]) -> Tuple[List[float], bool, bool]:
        actions = [_integer("action", action, 0, WAIT) for action in actions]
        events = self.episode.step(actions)
        self._actions += sum(action != WAIT for action in actions)
        done = self.episode.is_done
        return ([self._reward_of(event) for event in events], done,
                not done and self._actions >= self._action_limit * self.episode.robots)

    def _reward_of(self, event: _conav.Events) -> float:
        if event.goals:
            return self._reward["goal"] * event.goals
        if event.pictures:
            return self._reward["picture"]
        return self._reward["blocked"] if event.blocked else self._reward["step"]

    def _space_of_observations(self) -> Any:
        spaces = _spaces()
        shape = self.world.truth.shape

        def plane(high: float, kind: Any) -> Any:
            return spaces.Box(0, high, shape, kind)

        masks = {name: plane(1, np.uint8) for name in ("guidance", "goals", "path", "robots")}
        low = np.array([0, 0, -math.pi - 1e-3], np.float32)
        high = np.array([shape[0], shape[1], math.pi + 1e-3], np.float32)
        if self._pixels:
            masks["pixels"] = spaces.Box(0, 255, (*self._pixels, 3), np.uint8)
        return spaces.Dict({"map": plane(2, np.uint8), "belief": plane(1, np.float32), "picture": plane(2, np.uint8),
                            "pose": spaces.Box(low, high, (3,), np.float32), **masks})

    def result(self) -> Result:
        """Counts and mapping accuracy so far, for all robots together; keys as in `conav experiment --csv`."""
        return dict(self.episode.result())

    def method(self, name: str = "ig-mcts", robot: int = 0, **arguments: Any) -> _conav.Method:
        """A method for this episode, with the random numbers that `conav experiment` gives it."""
        from . import Method
        seed = self._seed if robot == 0 else _conav.derive_seed(self._seed, 1000 + robot)
        return Method(name, seed=_conav.derive_seed(seed, 1), x_source=self.scenario.x_source, **arguments)

    def decide(self, method: _conav.Method, robot: int = 0) -> int:
        """The action of a method; where it asks for the operator and waits, the operator is asked first."""
        decision = method.decide(self.episode.problem(robot))
        if decision.kind == "wait" and decision.asks:
            self.episode.ask(robot, decision)
            decision = method.decide(self.episode.problem(robot))
        if decision.target is not None:
            row, column = self.episode.problem(robot).cell
            return MOVES.index((decision.target[0] - row, decision.target[1] - column))
        if decision.heading_rad is not None:
            return len(MOVES) + round(decision.heading_rad * VIEWS / (2 * math.pi)) % VIEWS
        return WAIT


class ConavEnv(_Episodes):
    """One robot: gymnasium's Env. The info has `action_mask`, and at the end `result`."""

    metadata: Dict[str, Any] = {"render_modes": ["ansi"]}
    render_mode = "ansi"

    def __init__(self, operator: Union[str, Mapping[str, Any]] = "careful", scenario: Union[str, _conav.Scenario] = "paper",
                 **options: Any) -> None:
        super().__init__(operator, scenario, **options)
        if self.scenario.robots != 1:
            raise _conav.Error(f"ConavEnv has one robot, the scenario {self.scenario.robots}; ParallelConavEnv has several")
        self.action_space = _spaces().Discrete(WAIT + 1)
        self.observation_space = self._space_of_observations()

    @property
    def unwrapped(self) -> "ConavEnv":
        return self

    def _info(self) -> Dict[str, Any]:
        return {"action_mask": self.episode.action_mask()}

    def reset(self, *, seed: Optional[int] = None, options: Optional[Mapping[str, Any]] = None) -> Tuple[Observation, Dict[str, Any]]:
        """Without a seed the next one is drawn. options: {"world": a conav.World}."""
        self._reset(seed, options)
        if self.episode.robots != 1:
            raise _conav.Error(f"ConavEnv has one robot, the world {self.episode.robots}")
        return self.episode.observe(), self._info()

    def step(self, action: int) -> Tuple[Observation, float, bool, bool, Dict[str, Any]]:
        (reward,), terminated, truncated = self._step([action])
        info = self._info()
        if terminated or truncated:
            info["result"] = self.result()
        return self.episode.observe(), reward, terminated, truncated, info

    def play(self, method: _conav.Method) -> Result:
        """The rest of the episode by a method."""
        ended = self.episode.is_done
        while not ended:
            action = self.decide(method)
            if action == WAIT:
                break
            _, terminated, truncated = self._step([action])
            ended = terminated or truncated
        return self.result()

    def render(self) -> str:
        """The robot's map: # wall, . free, ? unknown, G goal, @ the robot."""
        problem = self.episode.problem()
        rows = [["?.#"[value] for value in row] for row in problem.map]
        for row, column in problem.goals:
            rows[row][column] = "G"
        rows[problem.cell[0]][problem.cell[1]] = "@"
        return "\n".join("".join(row) for row in rows)

    def close(self) -> None:
        pass


class ParallelConavEnv(_Episodes):
    """Several robots, whose only common map is the operator's: PettingZoo's ParallelEnv. All robots act, and a step ends
    when the last of them is done; the episode ends for all together, as a robot at its last goal may still make room."""

    metadata: Dict[str, Any] = {"name": "conav_v0", "render_modes": []}

    def __init__(self, robots: int = 2, operator: Union[str, Mapping[str, Any]] = "careful", scenario: str = "paper",
                 **options: Any) -> None:
        super().__init__(operator, scenario, robots=robots, **options)
        self.possible_agents = [f"r{i + 1}" for i in range(robots)]
        self.agents: List[str] = []
        self.observation_spaces = {agent: self._space_of_observations() for agent in self.possible_agents}
        self.action_spaces = {agent: _spaces().Discrete(WAIT + 1) for agent in self.possible_agents}

    @property
    def unwrapped(self) -> "ParallelConavEnv":
        return self

    def observation_space(self, agent: str) -> Any:
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Any:
        return self.action_spaces[agent]

    def _observe(self) -> Tuple[Dict[str, Observation], Dict[str, Dict[str, Any]]]:
        return ({agent: self.episode.observe(i) for i, agent in enumerate(self.possible_agents)},
                {agent: {"action_mask": self.episode.action_mask(i)} for i, agent in enumerate(self.possible_agents)})

    def reset(self, seed: Optional[int] = None, options: Optional[Mapping[str, Any]] = None
              ) -> Tuple[Dict[str, Observation], Dict[str, Dict[str, Any]]]:
        """As ConavEnv.reset()."""
        self._reset(seed, options)
        if self.episode.robots != len(self.possible_agents):
            raise _conav.Error(f"the world has {self.episode.robots} robots, not {len(self.possible_agents)}")
        self.agents = list(self.possible_agents)
        return self._observe()

    def step(self, actions: Mapping[str, int]) -> Tuple[Dict[str, Observation], Dict[str, float], Dict[str, bool],
                                                        Dict[str, bool], Dict[str, Dict[str, Any]]]:
        """A robot without an action waits."""
        unknown = set(actions) - set(self.possible_agents)
        if unknown:
            raise _conav.Error(f"step: no robot is called {sorted(unknown)[0]}; there are {self.possible_agents}")
        rewards, terminated, truncated = self._step([actions.get(agent, WAIT) for agent in self.possible_agents])
        observations, infos = self._observe()
        if terminated or truncated:
            self.agents = []
            for info in infos.values():
                info["result"] = self.result()
        agents = self.possible_agents
        return (observations, dict(zip(agents, rewards)), dict.fromkeys(agents, terminated),
                dict.fromkeys(agents, truncated), infos)

    def close(self) -> None:
        pass
