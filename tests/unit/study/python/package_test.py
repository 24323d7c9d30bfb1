"""package_test.py BUILD_FOLDER: worlds, models, operators, decisions and environments of the Python package."""
import csv
import math
import subprocess
import sys
import tempfile
import threading
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

BUILD = Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(BUILD / "python"))

import numpy as np  # noqa: E402

import conav  # noqa: E402
from conav import environment, spaces  # noqa: E402


def belief_of(world):
    return (world.human_map == conav.WALL).astype(np.float32)


def known_from(world, cell):
    free, walls = conav.cast_range(world.truth, cell)
    known = np.zeros_like(world.truth)
    for seen, value in ((free, conav.FREE), (walls, conav.WALL)):
        for row, column in seen:
            known[row, column] = value
    return known


class Worlds(unittest.TestCase):
    def test_the_maze_of_a_seed_is_that_of_conav_maze(self):
        world = conav.World(seed=7, robots=2)
        self.assertEqual(world.truth.shape, (13, 13))
        self.assertEqual(int((world.truth != world.human_map).sum()), 20)  # 12 % of 169 cells
        self.assertEqual([len(goals) for goals in world.goals], [4, 4])
        self.assertTrue(all(world.truth[cell] == conav.FREE for cell in world.starts + sum(world.goals, [])))

    def test_own_maps_are_played_and_wrong_ones_refused(self):
        truth = np.full((3, 5), conav.WALL, np.uint8)
        truth[1, 1:4] = conav.FREE
        world = conav.World.from_maps(truth, truth, [(1, 1)], [[(1, 3)]])
        env = conav.ConavEnv()
        env.reset(seed=1, options={"world": world})
        self.assertEqual(env.play(env.method("greedy"))["moves"], 2)
        for starts, goals, text in (([(0, 0)], [[(1, 3)]], "start (0,0)"), ([(1, 1)], [[(0, 1)]], "goal (0,1)"),
                                    ([(1, 1)], [[]], "no goal"), ([], [], "no robot")):
            with self.assertRaisesRegex(conav.Error, text.replace("(", r"\(").replace(")", r"\)")):
                conav.World.from_maps(truth, truth, starts, goals)

    def test_errors_have_the_text_of_the_programs(self):
        world = conav.World(seed=1)
        view = conav.cast_view(world.truth, world.starts[0], 0.0)
        refused = (
            (lambda: conav.World(preset="moon"), 'maze preset "moon" is unknown'),
            (lambda: conav.nhpm("/nowhere.nhpm"), "/nowhere.nhpm: no such file"),
            (lambda: conav.Method("teleop"), "teleop"),
            (lambda: conav.Method(search={"iterationz": 1}), "unknown key 'iterationz'"),
            (lambda: conav.Method(search={"iterations": 0}), "out of range"),
            (lambda: conav.glpf(alpha_d=-1), "alpha_d"),
            (lambda: conav.Operator("mean"), "kind"),
            (lambda: conav.cast_view(world.truth, (99, 0), 0.0), "outside of the map"),
            (lambda: conav.cast_view(world.truth, (1, 1), math.nan), "not a number"),
            (lambda: conav.glpf().predict(belief_of(world) + 2, [world.starts[0]], view), r"outside of \[0, 1\]"),
            (lambda: conav.Problem(world.truth, belief_of(world)[1:], (1, 1), []), "different sizes"),
            (lambda: conav.ConavEnv().episode.step([13]), "out of range"),
            (lambda: conav.ConavEnv().episode.step([]), "0 actions for 1 robots"),
            (lambda: conav.ConavEnv().episode.observe(1), "robot 1 is out of range"),
            (lambda: conav.ConavEnv(reward={"gold": 1.0}), "reward: unknown key 'gold'"),
            (lambda: conav.Scenario("moon"), "no scenario 'moon'; there are paper"),
            (lambda: conav.ConavEnv(goal_knowledge="some"), "goal_knowledge"),
            (lambda: conav.ConavEnv(scenario="team"), "ConavEnv has one robot"),
            (lambda: conav.ConavEnv(pixels=(8, 64)), r"8 is out of range \[16, 4096\]"),
            (lambda: conav.ConavEnv(pixels=(64, 64), streams=True), "not with streams"),
            (lambda: conav.run_experiment(operators=["mean"]), "mean"),
        )
        for call, text in refused:
            with self.subTest(text), self.assertRaisesRegex(conav.Error, text):
                call()

    def test_wrong_types_and_numbers_are_refused_by_name(self):
        world, env = conav.World(seed=1), conav.ConavEnv()
        truth, belief, start = world.truth, belief_of(world), world.starts[0]
        nan, inf = math.nan, math.inf
        refused = (
            (conav.World, "seed", (-1, 1.5, nan, "one", 2**64)),
            (conav.World, "robots", (1.5, np.float32(1.5), nan, 2**40)),
            (conav.World, "cell_size_m", (nan, inf, "2")),
            (conav.World, "wrong_share", (nan, -1, None)),
            (conav.World, "shared_goals", (2, "yes")),
            (conav.World, "preset", (7,)),
            (conav.World, "starts", (5, [(1, 1.5)])),
            (conav.World, "bogus", (1,)),
            (conav.Operator, "seed", (-1, 1.5, nan)),
            (conav.Operator, "patience_s", (nan, [set()], {1: set()})),
            (conav.glpf, "alpha_d", (nan, inf, np.int64(1))),
            (conav.Method, "seed", (-1, 1.5)),
            (conav.Method, "search", (5, {"exploration_constant": nan})),
            (conav.Method, "communication", (5,)),
            (conav.Method, "model", ("nhpm",)),
            (conav.Scenario().world, "seed", (-1, nan)),
            (conav.run_experiment, "seeds", (0, 1.5)),
            (conav.run_experiment, "first_seed", (-1,)),
            (conav.run_experiment, "variant", ("ig-mcts",)),
            (conav.run_experiment, "operators", ("careful", 5)),
            (conav.ConavEnv, "action_limit", (0, -5, 1.5, nan, "9")),
            (conav.ConavEnv, "reward", (5, *({"picture": value} for value in (nan, -inf, "1", None)))),
            (conav.ConavEnv, "operator", (5,)),
            (conav.ConavEnv, "pixels", (5, (nan, 64), (64.5, 64))),
            (conav.ParallelConavEnv, "robots", (nan, 1.5, 0)),
            (env.reset, "seed", (-1, 1.5, nan)),
            (env.reset, "options", (5, {"bogus": 1})),
            (lambda **world: env.reset(options=world), "world", (5,)),
            (env.step, "action", (nan, 1.5, -1, 13, None)),
            (lambda **actions: conav.ParallelConavEnv().step(actions), "r1", (nan, 13)),
            (lambda heading_rad: conav.View(start, heading_rad, [], []), "heading_rad", (nan, inf, "east")),
            (lambda heading_rad: conav.cast_view(truth, start, heading_rad), "heading_rad", (nan, inf, "east")),
            (lambda range_cells: conav.cast_range(truth, start, range_cells), "range_cells", (nan, inf, "far")),
            (lambda **more: conav.Problem(truth, belief, start, [], **more), "cell_size_m", (nan, inf)),
            (lambda **more: conav.Problem(truth, belief, start, [], **more), "pictures", (-1, nan)),
            (lambda cell_size_m: conav.World.from_maps(truth, truth, [start], world.goals, cell_size_m), "cell_size_m", (nan, "2")),
            (lambda truth: conav.cast_range(truth, start), "truth", (truth + nan, truth + 0.5, truth + 256, "map")),
            (lambda belief: conav.mapping_accuracy(truth, truth, belief), "belief", (belief + nan,)),
            (lambda seed: conav.derive_seed(seed, 1), "seed", (-1, 1.5)),
        )
        for call, name, values in refused:
            for value in values:
                with self.subTest(f"{name} = {value}"), self.assertRaisesRegex(conav.Error, "action" if name == "r1" else name):
                    call(**{name: value})
        self.assertEqual(conav.World(seed=np.uint8(7), cell_size_m=2, map="").truth.shape, (13, 13))
        self.assertEqual(conav.ConavEnv(action_limit=np.int64(1), reward={"step": np.float32(1)}).reset(options={})[0]["map"].shape, (13, 13))


class ModelsAndDecisions(unittest.TestCase):
    def setUp(self):
        self.world = conav.World(seed=1)
        self.start = self.world.starts[0]
        self.belief = belief_of(self.world)

    def test_models_predict_edits_where_the_belief_is_wrong(self):
        views = [conav.cast_view(self.world.truth, self.start, heading) for heading in (0.0, -math.pi / 2)]
        for model in (conav.nhpm(), conav.glpf()):
            with self.subTest(model.identity["name"]):
                add, remove = model.predict(self.belief, [self.start], views[0])
                self.assertEqual((add.shape, add.dtype), (self.belief.shape, np.dtype(np.float32)))
                self.assertEqual(float(add[self.belief == 1].sum()), 0.0)
                self.assertEqual(float(remove[self.belief == 0].sum()), 0.0)
                edits = model.predict_edits(self.belief, [self.start], views)
                self.assertAlmostEqual(edits[0], float(add.sum() + remove.sum()), places=4)
        self.assertEqual(len(conav.nhpm().identity["checksum"]), 64)

    def test_one_call_decides_and_tells_the_statistics_of_the_root(self):
        problem = conav.Problem(known_from(self.world, self.start), self.belief, self.start, self.world.goals[0])
        decision = conav.decide(problem, search={"iterations": 500})
        self.assertEqual(decision.iterations, 500)
        self.assertEqual(sum(action.visits for action in decision.actions), 500)
        best = max(decision.actions, key=lambda action: action.visits)
        self.assertEqual((decision.kind, decision.target), ("move", best.target))
        self.assertAlmostEqual(sum(best.terms.values()), best.mean_value, places=3)
        self.assertEqual(conav.decide(problem, search={"iterations": 500}).plan, decision.plan)
        self.assertEqual(conav.decide(problem, "greedy").kind, "move")
        asking = conav.decide(problem, "instruction")
        self.assertEqual((asking.kind, asking.asks), ("wait", True))

    def test_decisions_of_two_threads_run_at_once(self):
        problem = conav.Problem(known_from(self.world, self.start), self.belief, self.start, self.world.goals[0])
        counts = []
        threads = [threading.Thread(target=lambda: counts.append(conav.decide(problem, search={"iterations": 20000}).nodes))
                   for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(counts[0], counts[1])

    def test_an_operator_corrects_what_a_picture_shows(self):
        operator = conav.Operator("careful", seed=1, reader={"edit_probability": 1.0, "decay_cells": 1e6, "lapse_probability": 0.0})
        first = operator.show_start(self.belief, self.start, self.world.goals[0])
        self.assertEqual((first.edits, first.path[0]), ([], self.start))
        wrong = 0
        belief = self.belief
        for heading in np.arange(8) * math.pi / 4:
            view = conav.cast_view(self.world.truth, self.start, float(heading))
            answer = operator.show_picture(belief, view, [self.start], self.world.goals[0])
            self.assertEqual({bool(answer.belief[cell]) == wall for cell, wall in answer.edits} - {True}, set())
            belief, wrong = answer.belief, wrong + len(answer.edits)
        self.assertGreater(wrong, 0)
        self.assertGreater(conav.mapping_accuracy(self.world.truth, self.world.human_map, belief), 0.0)
        wall = (self.start[0] + 1, self.start[1])
        marked = operator.show_blocked(np.zeros_like(belief), self.start, wall, self.world.goals[0])
        self.assertIn((wall, True), marked.edits)
        self.assertNotIn(wall, marked.path)
        self.assertIsNone(conav.Operator("silent").show_start(belief, self.start, self.world.goals[0]).path)


class Environments(unittest.TestCase):
    def rows_of_program(self, *arguments):
        """The episodes that conav-experiment writes."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "episodes.csv"
            subprocess.run([BUILD / "bin" / "conav-experiment", *arguments, "--jobs", "1", "--csv", file], check=True,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            return list(csv.DictReader(file.read_text().splitlines()))

    def check(self, result, row):
        for key in ("goals_reached", "moves", "optimal_moves", "blocked", "pictures", "guidance", "edits"):
            self.assertEqual(result[key], int(row[key]), key)
        for key in ("mapping_accuracy", "turning_rad"):
            self.assertAlmostEqual(result[key], float(row[key]), places=5, msg=key)

    def test_the_same_seeds_are_the_episodes_of_conav_experiment(self):
        with tempfile.TemporaryDirectory() as folder:
            variants = Path(folder) / "variants.yaml"
            variants.write_text("search_variants:\n  quick: {iterations: 200}\n  greedy: {method: greedy}\n"
                                "  blocked: {iterations: 200, communication: {policy: when_blocked}}\n")
            rows = self.rows_of_program("search", "--variants-file", variants, "--seeds", "3", "--first-seed", "20")
        arguments = {"quick": {"search": {"iterations": 200}}, "greedy": {"name": "greedy"},
                     "blocked": {"search": {"iterations": 200}, "communication": {"policy": "when_blocked"}}}
        self.assertEqual(len(rows), 36)
        for row in rows:
            with self.subTest(f"{row['variant']}, {row['operator']}, seed {row['seed']}"):
                env = conav.ConavEnv(row["operator"])
                env.reset(seed=int(row["seed"]))
                self.check(env.play(env.method(**arguments[row["variant"]])), row)

    def test_scenarios_are_those_of_conav_experiment(self):
        rows = self.rows_of_program("scenarios", "--scenarios", "seen-goals,no-map,search,closing-doors,team", "--methods", "greedy",
                                    "--seeds", "1", "--operators", "careful,hasty")
        methods = {"greedy": {"method": "greedy"}, "never": {"communication": {"policy": "never"}}, "ig-mcts": {}}
        count = 0
        for row in rows:
            if row["method"] == "ig-mcts-glpf":
                continue
            with self.subTest(f"{row['scenario']}, {row['method']}, {row['operator']}"):
                variant = dict(methods[row["method"]])
                scenario = conav.Scenario(row["scenario"])
                (result,) = conav.run_experiment(scenario, variant, [row["operator"]], int(row["seed"]))
                self.check(result, row)
                count += 1
                if row["scenario"] == "team":
                    continue
                env = conav.ConavEnv(row["operator"], scenario)
                env.reset(seed=int(row["seed"]))
                self.check(env.play(env.method(variant.pop("method", "ig-mcts"), **variant)), row)
        self.assertEqual(count, 30)

    def test_steps_have_the_interface_of_gymnasium(self):
        for options in ({}, {"marked_goals": True}, {"streams": True}, {"preset": "9x9", "operator": "hasty"}):
            env = conav.ConavEnv(action_limit=50, **options)
            observation, info = env.reset(seed=5)
            env.action_space.seed(5)
            self.assertTrue(env.observation_space.contains(observation))
            ended, steps = False, 0
            while not ended:
                observation, reward, terminated, truncated, info = env.step(env.action_space.sample(info["action_mask"]))
                self.assertTrue(env.observation_space.contains(observation))
                ended, steps = terminated or truncated, steps + 1
            self.assertEqual((steps, truncated), (50, True))
            self.assertEqual(info["result"]["goals"], len(env.world.goals[0]))

    def test_rewards_masks_and_pictures(self):
        env = conav.ConavEnv(reward={"picture": -3.0})
        observation, info = env.reset(seed=1)
        row, column = env.world.starts[0]
        for action, (south, east) in enumerate(environment.MOVES):
            is_wall = env.world.truth[row + south, column + east] == conav.WALL
            self.assertEqual(info["action_mask"][action], int(not is_wall))
        self.assertEqual(int(observation["picture"].sum()), 0)
        observation, reward, *_ = env.step(4)  # a picture to the east
        self.assertEqual((reward, float(observation["pose"][2])), (-3.0, 0.0))
        self.assertEqual(int(observation["picture"][row, column]), 1)
        blocked = int(np.flatnonzero(info["action_mask"] == 0)[0])
        self.assertEqual(env.step(blocked)[1], -1.0)
        self.assertEqual(env.result()["blocked"], 1)
        same = conav.ConavEnv()
        again = [same.reset(seed=9)[0] for _ in range(2)]
        self.assertTrue(all(np.array_equal(again[0][key], again[1][key]) for key in again[0]))

    def test_pixels_are_what_the_camera_shows(self):
        env = conav.ConavEnv(pixels=(48, 64), scenario="closing-doors")
        plain = conav.ConavEnv(scenario="closing-doors")
        observation, _ = env.reset(seed=3)
        plain.reset(seed=3)
        self.assertTrue(env.observation_space.contains(observation))
        self.assertEqual(int(observation["pixels"].max()), 0)  # no picture yet
        pictures = []
        for heading in range(environment.VIEWS):
            observation = env.step(4 + heading)[0]
            same = plain.step(4 + heading)[0]
            self.assertTrue(all(np.array_equal(same[key], observation[key]) for key in same))
            pictures.append(observation["pixels"])
            self.assertTrue(env.observation_space.contains(observation))
            self.assertGreater(float(pictures[-1].std()), 5.0)  # sky, walls and floor
        self.assertFalse(any(np.array_equal(a, b) for a, b in zip(pictures, pictures[1:])))
        before = pictures[-1]
        kept = env.step(int(np.flatnonzero(env.episode.action_mask()[:4])[0]))[0]
        self.assertTrue(np.array_equal(kept["pixels"], before))  # until the next picture
        env.play(env.method("greedy"))
        self.assertEqual(env.result()["goals_reached"], 4)
        closed = (env.episode.problem().map == conav.WALL) & (env.world.truth == conav.FREE)
        self.assertGreater(int(closed.sum()), 0)  # doors that the robot has seen
        self.assertGreater(float(env.step(5)[0]["pixels"].std()), 5.0)
        with ThreadPoolExecutor(1) as other, self.assertRaisesRegex(conav.Error, "one thread"):
            other.submit(env.step, 4).result()

    def test_several_robots_have_the_interface_of_pettingzoo(self):
        env = conav.ParallelConavEnv(robots=3)
        observations, infos = env.reset(seed=1)
        self.assertEqual((env.agents, list(observations)), (["r1", "r2", "r3"], ["r1", "r2", "r3"]))
        self.assertEqual(int(observations["r1"]["robots"].sum()), 2)
        methods = [env.method("greedy", robot) for robot in range(3)]
        for _ in range(300):
            if not env.agents:
                break
            actions = {agent: env.decide(methods[i], i) for i, agent in enumerate(env.agents)}
            observations, rewards, terminated, truncated, infos = env.step(actions)
            cells = {tuple(observation["pose"][:2]) for observation in observations.values()}
            self.assertEqual(len(cells), 3)  # never two in one cell
        self.assertEqual(set(terminated.values()), {True})
        self.assertEqual(infos["r2"]["result"]["goals_reached"], 12)
        with self.assertRaisesRegex(conav.Error, "r9"):
            env.step({"r9": 0})

    def test_spaces_without_gymnasium(self):
        space = spaces.Dict({"a": spaces.Box(0, 2, (2,), np.uint8), "b": spaces.Box(0, 1, (1,), np.float32)})
        space["a"].seed(1)
        self.assertTrue(space.contains(space.sample()))
        self.assertFalse(space.contains({"a": np.array([3, 0], np.uint8), "b": np.zeros(1, np.float32)}))
        self.assertEqual(spaces.Discrete(5).sample(np.array([0, 0, 1, 0, 0])), 2)
        self.assertFalse(spaces.Discrete(5).contains(5))


if __name__ == "__main__":
    unittest.main()
