"""commands_test.py BUILD_FOLDER: export, leaderboard, reproduce, scale, wheel and types of the Python package."""
import contextlib
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

BUILD = Path(sys.argv.pop(1)).resolve()
ROOT = Path(__file__).resolve().parents[4]
sys.path.insert(0, str(BUILD / "python"))

import numpy as np  # noqa: E402

import conav  # noqa: E402
from conav import __main__ as program, export, leaderboard, reproduce, scale  # noqa: E402


def run(*arguments):
    """Exit code, standard output and standard error of python3 -m conav."""
    out, err = io.StringIO(), io.StringIO()
    with mock.patch.object(sys, "argv", ["conav", *map(str, arguments)]), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = program.main()
        except SystemExit as ended:
            code = ended.code
    return code, out.getvalue(), err.getvalue()


class Commands(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_without_a_command_it_prints_what_there_is(self):
        code, out, _ = run()
        self.assertEqual(code, 0)
        for word in ("ConavEnv", "Example:", "decide(", "SIMULATED"):
            self.assertIn(word, out)
        self.assertIn("steps/s", run("bench", "--steps", 50)[1])
        self.assertIn("goals_reached      4", run("play", "--method", "greedy")[1])

    def test_episodes_are_exported_with_a_card(self):
        code, _, _ = run("export", "episodes", "--episodes", 2, "--method", "greedy", "--out", self.folder / "e.npz")
        self.assertEqual(code, 0)
        with np.load(self.folder / "e.npz") as data:
            self.assertEqual(set(data) - {name for names in export.EPISODE_FIELDS for name in names.split(", ")}, set())
            self.assertEqual(data["map"].shape, (len(data["action"]), 13, 13))
            self.assertEqual(sorted(set(data["seed"].tolist())), [1, 2])
            self.assertEqual(int(data["terminated"].sum()), 2)
        text = (self.folder / "e.md").read_text()
        for word in ("license: apache-2.0", "synthetic: true", "NOT about people", "`belief`"):
            self.assertIn(word, text)

    def test_segments_are_exported_as_the_file_has_them(self):
        file = self.folder / "s.pb.zst"
        program_path = BUILD / "bin" / "conav-dataset"
        subprocess.run([program_path, "synthesize", "--trajectories", "20", "--threads", "1", "--out", file], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        lines = subprocess.run([program_path, "export", file], check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
        self.assertEqual(run("export", "segments", file, "--out", self.folder / "s.npz")[0], 0)
        segments = [json.loads(line) for line in lines if '"type":"segment"' in line.replace(" ", "")]
        with np.load(self.folder / "s.npz") as data:
            self.assertEqual(len(data["x"]), len(segments))
            for i in (0, len(segments) - 1):
                self.assertEqual("".join(map(str, data["x_next"][i].ravel())), segments[i]["x_next"])
                self.assertEqual(int(data["tau"][i].max()), len(segments[i]["tau"]))
            splits = {(trajectory, split) for trajectory, split in zip(data["trajectory"].tolist(), data["split"].tolist())}
            self.assertEqual(len(splits), 20)  # no trajectory is in two
        self.assertIn("synthetic: true", (self.folder / "s.md").read_text())
        (self.folder / "bad.jsonl").write_text("{}\n")
        code, _, err = run("export", "segments", self.folder / "bad.jsonl", "--out", self.folder / "t.npz")
        self.assertEqual((code, "line 1" in err), (1, True))

    def test_wrong_use_is_exit_code_2_with_what_is_wrong(self):
        good, none = self.folder / "good.json", self.folder / "none"
        good.write_text(json.dumps(self.entry()))
        out = ("--out", self.folder / "e.npz")
        for arguments, text in ((("leaderboard", none), f"{none}: No such file"), (("leaderboard", self.folder), f"{self.folder}: Is a directory"),
                                (("leaderboard", "--make", "X", none), f"{none}: No such file"), (("leaderboard", "--make", "X"), "--make"),
                                (("leaderboard", "--make", "X", good, "--seeds", "nan"), "--seeds nan"),
                                (("leaderboard", "--make", "X", good, "--seeds", "3-1"), "--seeds 3-1"),
                                (("export", "segments", none, *out), f"{none}: no such file"),
                                (("export", "segments", f"{none}.jsonl", *out), f"{none}.jsonl: No such file"),
                                (("export", "segments", good, "--out", "e.xyz"), "e.xyz: expected a name that ends in .npz"),
                                (("export", "episodes", "--out", "e.xyz"), "e.xyz: expected a name that ends in .npz"),
                                (("export", "episodes", "--out", none / "e.npz"), f"{none}: no such folder"),
                                (("export", "episodes", "--episodes", 0, *out), "--episodes = 0"),
                                (("export", "episodes", "--first-seed", -1, *out), "seed = -1"),
                                (("export", "episodes", "--operator", "mean", *out), "mean"),
                                (("bench", "--steps", 0), "--steps = 0"), (("play", "--search", "none"), "none"), (("play", "--seed", -1), "seed = -1"),
                                (("reproduce", "--only", "none"), "--only none")):
            with self.subTest(arguments):
                code, _, err = run(*arguments)
                self.assertEqual((code, text in err), (2, True), err)

    def python(self, *arguments, **options):
        return subprocess.Popen([sys.executable, *map(str, arguments)], env={**os.environ, "PYTHONPATH": str(BUILD / "python")}, stderr=subprocess.PIPE, text=True, **options)

    def test_a_closed_pipe_ends_it_quietly(self):
        for arguments in ((), ("--help",), ("leaderboard", *(ROOT / "docs/data/results").glob("*.json"))):
            reader, writer = os.pipe()
            os.close(reader)
            with self.subTest(arguments), self.python("-m", "conav", *arguments, stdout=writer) as process:
                os.close(writer)
                self.assertEqual(process.communicate()[1], "")

    def test_without_numpy_it_names_what_it_needs(self):
        for arguments, code, count in ((("-S", "-m", "conav"), 1, 1), (("-S", "-c", "import conav"), 1, None)):
            with self.subTest(arguments), self.python(*arguments) as process:
                err = process.communicate()[1]
                self.assertEqual((process.returncode, "python3-numpy" in err, "/usr/bin/python3" in err), (code, True, True), err)
                self.assertIn(count, (None, err.count("\n")))

    def test_parquet_needs_pyarrow(self):
        with mock.patch("importlib.import_module", side_effect=ImportError), self.assertRaisesRegex(conav.Error, "pyarrow"):
            export.write(self.folder / "e.parquet", {"a": np.zeros(1)})

    def entry(self, **changes):
        measures = {"steps_mean": 250.0, "bytes_mean": 9e5, "pictures_mean": 5.0, "mapping_accuracy_mean": 0.5, "goals_reached_fraction": 1.0}
        better = {**measures, "steps_mean": 200.0}
        return {"name": "mine", "conav_version": "0.2.0", "seeds": [1, 100], "hardware": "2 cores", "synthetic": True,
                "scenarios": {"search": {"slow": measures, "fast": better}}, **changes}

    def test_the_leaderboard_is_sorted(self):
        file = self.folder / "mine.json"
        file.write_text(json.dumps(self.entry()))
        code, out, _ = run("leaderboard", file)
        self.assertEqual(code, 0)
        self.assertLess(out.index("fast"), out.index("slow"))
        self.assertIn("SIMULATED", out)
        source = self.folder / "scenarios.json"
        source.write_text(json.dumps({"scenarios": self.entry()["scenarios"], "person_matters": ["search"]}))
        code, out, _ = run("leaderboard", "--make", "ours", source, "--seeds", "1-30")
        made = json.loads(out)
        self.assertEqual((made["name"], made["seeds"], made["synthetic"]), ("ours", [1, 30], True))
        self.assertEqual(made["scenarios"], self.entry()["scenarios"])
        figure = {"mean": 1.0, "low": 0.5, "high": 1.5}
        other = {"search": {"slow": {"steps_mean": 9.0, "operators": {"hasty": {"steps": figure, "pictures": figure, "goals_reached_fraction": 0.5, "moves_mean": 3}}}}}
        second = self.folder / "hasty.json"
        second.write_text(json.dumps({"scenarios": other}))
        slow = json.loads(run("leaderboard", "--make", "ours", source, second)[1])["scenarios"]["search"]["slow"]
        self.assertEqual((slow["steps_mean"], slow["operators"]), (250.0, {"hasty": {"steps": figure, "pictures": figure, "goals_reached_fraction": 0.5}}))
        self.assertEqual(run("leaderboard", "--make", "ours", source, "--out", self.folder / "ours.json")[1], "")
        self.assertEqual(leaderboard.read(self.folder / "ours.json")["name"], "ours")

    def test_wrong_results_are_refused_by_key(self):
        method = {"steps_mean": 1.0, "bytes_mean": 1.0, "pictures_mean": 1.0, "goals_reached_fraction": 1.0}
        for changes, key in (({"name": ""}, "name"), ({"seeds": [3, 1]}, "seeds"), ({"seeds": "1-3"}, "seeds"),
                             ({"synthetic": "yes"}, "synthetic"), ({"scenarios": {}}, "scenarios"),
                             ({"scenarios": {"a": {"m": method}}}, "scenarios.a.m.mapping_accuracy_mean"),
                             ({"scenarios": {"a": {"m": {**method, "mapping_accuracy_mean": 2}}}}, "mapping_accuracy_mean"),
                             ({"scenarios": {"a": {"m": {**method, "mapping_accuracy_mean": float("nan")}}}}, "mapping_accuracy_mean"),
                             ({"scenarios": {"a": {"m": {**method, "steps_mean": float("inf")}}}}, "steps_mean")):
            with self.subTest(key), self.assertRaisesRegex(conav.Error, f"f.json: .*{key}"):
                leaderboard.check(self.entry(**changes), "f.json")
        file = self.folder / "broken.json"
        for text in ("{", '{"seeds": NaN}', '{"seeds": -Infinity}'):
            file.write_text(text)
            self.assertEqual(run("leaderboard", file)[0], 1)
            with self.subTest(text), self.assertRaisesRegex(conav.DataError, "not JSON"):
                leaderboard.read(file)

    def test_results_of_conav_are_good(self):
        for file in (ROOT / "docs/data/results").glob("*.json"):
            leaderboard.read(file)
        schema = json.loads((ROOT / "docs/data/leaderboard.schema.json").read_text())
        self.assertEqual(set(schema["required"]), {*leaderboard.TEXTS, "seeds", "synthetic", "scenarios"})
        measures = schema["properties"]["scenarios"]["additionalProperties"]["additionalProperties"]
        self.assertEqual(measures["required"], list(leaderboard.MEASURES))


class Reproduce(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def checkout(self, items):
        """A checkout whose ./conav counts its calls and writes the steps that it is given."""
        (self.folder / "docs/data").mkdir(parents=True)
        (self.folder / "docs/page.md").write_text("| steps | 12.3 | 40 % |\n")
        conav_script = self.folder / "conav"
        conav_script.write_text('#!/bin/sh\n[ "$1" = --version ] && echo "conav 9" && exit\necho "$*" >>calls\n[ "$1" = ok ] || exit 3\n'
                                'echo "{\\"rows\\": [{\\"m\\": \\"a\\", \\"steps\\": $2, \\"share\\": 0.4}]}" >"$3"\n')
        conav_script.chmod(0o755)
        (self.folder / "items.json").write_text(json.dumps(items))

    def reproduce(self, *arguments):
        before = os.getcwd()
        os.chdir(self.folder)
        try:
            with mock.patch.object(reproduce, "ITEMS", self.folder / "items.json"):
                return run("reproduce", "--out", self.folder / "out", *arguments)
        finally:
            os.chdir(before)

    def test_items_are_run_once_and_compared_with_pages(self):
        item = {"name": "one", "commands": ["ok 12.34 {json}"], "quick": ["ok 1 {json}"], "row_names": ["m"], "figures": ["rows.*"],
                "texts": {"docs/page.md": ["| steps | {rows.a.steps:.1f} | {rows.a.share:.0%} % |"]}}
        self.checkout([item, {"name": "two", "commands": ["fail"], "quick": ["ok 2 {json}"]}])
        code, out, err = self.reproduce("--update")
        self.assertEqual(code, 1)
        self.assertIn("two: ./conav fail: exit code 3", err)
        kept = json.loads((self.folder / "docs/data/reproduce.json").read_text())
        self.assertEqual(kept["one"]["figures"], {"rows.a.steps": 12.34, "rows.a.share": 0.4})
        self.assertEqual(kept["one"]["command"], "./conav ok 12.34 {json}")
        self.assertEqual(self.reproduce("--only", "one")[0], 0)
        self.assertEqual((self.folder / "calls").read_text().count("ok 12.34"), 1)
        self.assertIn("12.34", (self.folder / "out/reproduce.html").read_text())
        (self.folder / "docs/page.md").write_text("| steps | 12.9 | 40 % |\n")
        code, out, _ = self.reproduce("--only", "one")
        self.assertEqual(code, 1)
        self.assertIn("docs/page.md does not print: | steps | 12.3 | 40 % |", out)
        self.assertEqual(self.reproduce("--only", "three")[0], 2)

    def test_lines_with_rows_and_kept_files(self):
        line = {"line": "$1: {rows.$2.steps:.0f}{rows.$2.share:part}", "rows": [["A", "a"], ["B", "b"]]}
        item = {"name": "one", "commands": ["ok 12.34 {json}"], "quick": [], "row_names": ["m"], "figures": ["rows.*"],
                "kept": "docs/data/one.json", "texts": {"docs/page.md": [line]}}
        self.checkout([item])
        (self.folder / "docs/page.md").write_text("A: 12 (40 %) and B")
        code, out, _ = self.reproduce("--update")
        self.assertEqual((code, "no figure rows.b.steps" in out, "rows.a" in out), (1, True, False))
        self.assertNotIn("figures", json.loads((self.folder / "docs/data/reproduce.json").read_text())["one"])
        kept = self.folder / "docs/data/one.json"
        self.assertEqual(json.loads(kept.read_text())["rows"][0]["steps"], 12.34)
        kept.write_text('{"rows": [{"m": "a", "steps": 2, "share": 1}, {"m": "b", "steps": 3.2, "share": 0}]}')
        self.assertEqual(reproduce.differences([item], {}, self.folder), ["docs/page.md does not print: A: 2", "docs/page.md does not print: B: 3 (0 %)"])
        (self.folder / "docs/page.md").write_text("A: 2 B: 3 (0 %)")
        self.assertEqual(reproduce.differences([item], {}, self.folder), [])

    def test_commands_are_run_for_each_seed(self):
        item = {"name": "one", "commands": ["ok {seed}0 {dir}/a-{seed}.json", "ok 7 {json}", "ok 1 {dir}/b.json {dir}/a-*.json"],
                "quick": ["ok {seed}0 {dir}/a-{seed}.json"], "seeds": [1, 2, 11], "row_names": ["m"], "figures": ["a.rows.a.steps.*"],
                "texts": {"docs/page.md": ["{a.rows.a.steps.mean:.1f} from {a.rows.a.steps.min:.0f} to {a.rows.a.steps.max:.0f}, {a.rows.a.steps.sum:d}"]}}
        self.checkout([item])
        (self.folder / "docs/page.md").write_text("46.7 from 10 to 110, 140")
        code, out, err = self.reproduce()
        self.assertEqual(code, 0, out + err)
        files = " ".join(str(self.folder / f"out/one/a-{seed}.json") for seed in (1, 11, 2))
        self.assertIn(f"ok 1 {self.folder}/out/one/b.json {files}\n", (self.folder / "calls").read_text())
        (self.folder / "calls").unlink()
        run_quick = self.reproduce("--quick", "--out", self.folder / "quick")
        self.assertEqual(run_quick[0], 0, run_quick)
        self.assertEqual((self.folder / "calls").read_text(), f"ok 10 {self.folder}/quick/one/a-1.json\n")

    def test_pages_print_the_figures_of_the_last_run(self):
        last = json.loads((ROOT / "docs/data/reproduce.json").read_text())
        items = json.loads((ROOT / "services/study/python/conav/reproduce_items.json").read_text())
        self.assertEqual(reproduce.differences(items, last, ROOT), [])
        for item in items:
            self.assertEqual(set(item) - {"name", "commands", "quick", "row_names", "figures", "kept", "texts", "exit_codes", "seeds"}, set())
            if item["name"] in last:
                commands = " && ".join(f"./conav {command}" for command in item["commands"])
                self.assertEqual(last[item["name"]]["command"], commands)


class Scale(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_queues_of_operators_are_those_computed_by_hand(self):
        def costs(neglect, interaction):
            return {"neglect_s": neglect, "interaction_s": interaction, "interaction_log_sd": 0.5}

        two = scale.predict(2, 1, costs(1.0, 1.0))  # 0, 1, 2 robots ask with 1/5, 2/5, 2/5
        for value, expected in ((two.utilisation, 0.8), (two.wait_s, 0.5), (two.driving, 0.8)):
            self.assertAlmostEqual(value, expected)
        many = scale.predict(20_000, 3, costs(10_000.0, 1.0))  # Erlang's C for 2 of 3 busy: 4/9
        self.assertAlmostEqual(many.wait_s, 4.0 / 9.0, places=2)
        for robots, operators in ((8, 1), (20, 4)):
            predicted = scale.predict(robots, operators, costs(32.9, 6.2))
            simulated = scale.attend(robots, operators, costs(32.9, 6.2), hours=100.0, exponential=True)
            for name in ("utilisation", "wait_s", "driving"):
                self.assertAlmostEqual(getattr(simulated, name) / getattr(predicted, name), 1.0, delta=0.03, msg=name)
        certain = scale.attend(1, 1, {**costs(30.0, 10.0), "interaction_log_sd": 1e-9}, hours=1000.0)
        self.assertAlmostEqual(certain.utilisation, 10.0 / 40.0, delta=0.005)
        self.assertEqual((certain.wait_s, certain.wait_p95_s), (0.0, 0.0))
        needed = scale.operators_for(1000, 10.0, costs(32.9, 6.2))
        self.assertLessEqual(scale.predict(1000, needed, costs(32.9, 6.2)).wait_s, 10.0)
        self.assertGreater(scale.predict(1000, needed - 1, costs(32.9, 6.2)).wait_s, 10.0)

    def test_scale_takes_what_benchmarks_measured_and_refuses_other_files(self):
        file, bench = ROOT / "docs/data/scale.json", self.folder / "bench.json"
        bench.write_text(json.dumps({"metrics": {"robots100_cores": 4.0, "operator_link_bytes_per_s_per_robot": 3000.0}}))
        code, out, _ = run("scale", "--costs", file, "--bench", bench, "--hours", 0.2, "--json", self.folder / "scale.json")
        self.assertEqual(code, 0)
        self.assertIn("robots that drive", out)
        found = json.loads((self.folder / "scale.json").read_text())
        self.assertEqual((found["costs"]["cores_per_robot"], found["costs"]["dds_bytes_per_s_per_robot"]), (0.04, 3000.0))
        row = found["resources"]["sites processors of a site: one host"]
        self.assertAlmostEqual(row["use"], 50 * 0.04 / 2)
        self.assertAlmostEqual(row["full_at_robots"], 1000.0, places=3)
        good = json.loads(file.read_text())
        for change, word in (({"neglect_s": [0, "x"]}, "neglect_s"), ({"planners": 16}, "planners"), ({"colour": [1, "x"]}, "colour")):
            (self.folder / "bad.json").write_text(json.dumps({**good, **change}))
            code, _, error = run("scale", "--costs", self.folder / "bad.json")
            self.assertEqual((code, word in error), (1, True), error)
        self.assertEqual(run("scale", "--costs", file, "--bench", file)[0], 1)
        self.assertEqual(run("scale", "--costs", file, "--operators", 2000)[0], 2)
        self.assertEqual(run("scale", "--costs", self.folder / "none.json")[0], 2)


class Package(unittest.TestCase):
    def test_the_wheel_installs_into_a_fresh_environment(self):
        with tempfile.TemporaryDirectory() as text:
            folder = Path(text)
            python = folder / "venv/bin/python"
            source = folder / "source"
            shutil.copytree(BUILD / "python", source)
            subprocess.run([sys.executable, "setup.py", "-q", "bdist_wheel", "-d", folder], cwd=source, check=True, capture_output=True)
            (wheel,) = folder.glob("*.whl")
            subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", folder / "venv"], check=True)
            subprocess.run([python, "-m", "pip", "install", "-q", "--no-index", "--no-deps", wheel], check=True)
            shutil.rmtree(source)
            done = subprocess.run([python, "-I", "-m", "conav", "play"], stdout=subprocess.PIPE, text=True, check=True)
            self.assertIn("goals_reached      4", done.stdout)

    def test_the_types_are_right(self):
        mypy = shutil.which("mypy", path="/usr/bin")
        if mypy is None:
            self.skipTest("no mypy")
        sources = ROOT / "services/study/python/conav"
        done = subprocess.run([mypy, "--strict", "--cache-dir=/dev/null", "--allow-any-generics", sources], stdout=subprocess.PIPE, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_the_stubs_have_the_names_of_the_module(self):
        stub = (ROOT / "services/study/python/conav/_conav.pyi").read_text()
        for name, value in vars(conav._conav).items():
            if name.startswith("__"):
                continue
            self.assertIn(f"class {name}" if isinstance(value, type) else f"def {name}(", stub)
            for member in vars(value) if isinstance(value, type) else ():
                self.assertTrue(member.startswith("_") or f"def {member}(" in stub, f"{name}.{member}")


if __name__ == "__main__":
    unittest.main()
