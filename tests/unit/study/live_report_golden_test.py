#!/usr/bin/env python3
"""live_report_golden_test.py CONAV_STUDY_REPORT FOLDER: a synthetic study with people, and what its report says.

Writes the folder of a study with four complete participants, one who has not finished, one who was aborted and one whose result is cut
off (all synthetic), computes scores, tables and tests here, in plain Python that shares nothing with conav, and compares.
"""
import csv
import html
import itertools
import json
import math
import pathlib
import random
import re
import shutil
import statistics
import subprocess
import sys

METHODS = ["ig-mcts", "instruction", "teleop"]
TLX = ["mental", "physical", "temporal", "performance", "effort", "frustration"]
SUS = [f"q{i}" for i in range(1, 11)]
FORMS = {
    "consent": {"version": "2", "elements": [{"type": "boolean", "name": "agree", "title": "I agree"}]},
    "demographics": {"version": "1", "pages": [{"elements": [
        {"type": "text", "name": "age", "title": {"default": "Age", "de": "Alter"}, "min": 18, "max": 99},
        {"type": "radiogroup", "name": "gender", "title": "Gender", "choices": ["a", "b"]},
        {"type": "checkbox", "name": "games", "title": "Games, which?"},
        {"type": "comment", "name": "remark", "title": "Anything\nelse?"}]}]},
    "nasa-tlx": {"version": "1", "scoring": {"tlx": {"kind": "mean", "of": TLX}},
                 "elements": [{"type": "rating", "name": n, "title": n.title(), "rateMin": 0, "rateMax": 100} for n in TLX] +
                             [{"type": "rating", "name": "check", "title": "Choose 3", "attention": 3}]},
    "sus": {"version": "1", "scoring": {"sus": {"kind": "sus", "of": SUS}}, "elements": []},
    "trust": {"version": "1", "elements": [],
              "scoring": {"trust": {"kind": "mean", "of": ["t1", "t2", "t3"], "reversed": ["t2"], "max": 7}}},
    "debriefing": {"version": "1", "elements": [{"type": "comment", "name": "text", "title": "How was it?"}]},
}
REMARK = 'none, "really";\nsecond line'


class Study:
    def __init__(self, folder, seed):
        self.folder, self.random, self.trials = folder, random.Random(seed), {}
        (folder / "forms").mkdir(parents=True)
        for name, form in FORMS.items():
            (folder / "forms" / f"{name}.json").write_text(json.dumps(form))

    def participant(self, name, order, stop=None, aborted=False):
        """`stop`: after which step."""
        here = self.folder / name
        here.mkdir()
        steps, results, clock = [], [], 1.7e9
        for method in (None, *order, None):
            for step, kind in self.steps_of(method, bool(steps)):
                maze = {"layout": str(1000 + len(steps)), "rotation": 90 * (len(steps) % 4), "seed": 1000 + len(steps),
                        "training": step == "training", "robots": 1} if kind == "study" else {}
                form = step.removeprefix(f"{method}-")
                steps.append({"step": step, "kind": kind, **({"form": f"forms/{form}.json"} if kind == "form" else {}),
                              **({"method": method or "ig-mcts"} if method or kind == "study" else {}), **maze})
                if stop is not None and results and results[-1]["step"] == stop:
                    continue
                clock += 100.0
                result = {"kind": kind, "step": step, "participant": name, "began_at": clock, "finished_at": clock + 50.0,
                          "duration_s": 50.0, "paused_s": 0.0, "pauses": 0, "aborted": False, "reason": ""}
                if kind == "form":
                    result.update(form=form, version="1", answers=self.answers(form))
                    if form == "nasa-tlx":
                        result["attention_passed"] = result["answers"]["check"] == 3
                if kind == "study":
                    result.update(self.maze(method or "ig-mcts"), training=False, layout="")  # the design says it better
                path = f"{len(steps):02d}-{step}"
                (here / path).mkdir()
                (here / path / "result.json").write_text(json.dumps(result))
                results.append({**result, **maze, "folder": path})
        if aborted:
            results[-1].update(aborted=True, reason="fire alarm")
            (here / results[-1]["folder"] / "result.json").write_text(json.dumps({k: v for k, v in results[-1].items() if k != "folder"}))
        (here / "participant.json").write_text(json.dumps(
            {"participant": name, "synthetic": True, "protocol": "study", "protocol_fingerprint": "ab12", "order": 1, "language": "en",
             "parts": steps}))
        (here / "result.json").write_text(json.dumps(
            {"participant": name, "complete": stop is None, "aborted": aborted, "completion_code": "", "steps": results}))
        (here / "log.jsonl").write_text(json.dumps({"at": 1.0, "event": "step_begun", "step": "consent"}) + "\n" +
                                        json.dumps({"at": 2.0, "event": "process_died", "step": "teleop", "process": "planner"}) + "\n")
        self.trials[name] = [r for r in results if r["kind"] == "study" and not r["training"] and not r["aborted"]]
        for trial in self.trials[name]:
            trial["forms"] = {r["form"]: r["answers"] for r in results if r["step"].startswith(trial["step"] + "-")}

    @staticmethod
    def steps_of(method, is_end):
        if method:
            return [(method, "study")] + [(f"{method}-{form}", "form") for form in ("nasa-tlx", "sus", "trust")]
        if is_end:
            return [("debriefing", "form")]
        return [("consent", "form"), ("demographics", "form"), ("baseline", "rest"), ("training", "study")]

    def answers(self, form):
        draw = self.random
        return {"consent": lambda: {"agree": True},
                "demographics": lambda: {"age": draw.randint(20, 40), "gender": draw.choice("ab"), "games": ["go", "chess"],
                                         "remark": REMARK},
                "nasa-tlx": lambda: {**{n: draw.randint(0, 100) for n in TLX}, "check": draw.choice([3, 3, 4])},
                "sus": lambda: {n: draw.randint(1, 5) for n in SUS},
                "trust": lambda: {f"t{i}": draw.randint(1, 7) for i in (1, 2, 3)},
                "debriefing": lambda: {"text": "fine"}}[form]()

    def maze(self, method):
        level, draw = METHODS.index(method), self.random
        return {"method": method, "timed_out": False, "low_level_steps": 240 + 90 * level + draw.randint(0, 80), "cell_moves": 24 + draw.randint(0, 9),
                "pictures": 4 + 150 * level + draw.randint(0, 30), "guidance": draw.randint(1, 9), "image_bytes": 7000 * draw.randint(4, 90),
                "goals_reached": 4, "goals_total": 4, "mapping_accuracy": draw.random(), "cell_accuracy": 0.9 + 0.1 * draw.random(),
                "edits": draw.randint(1, 30), "duration_s": 60.0 + 100.0 * draw.random()}


def mean(values):
    return sum(values) / len(values)


def beta_share(a, b, x):
    """The regularised incomplete beta function, by Lentz' continued fraction."""
    if x <= 0.0 or x >= 1.0:
        return float(x >= 1.0)
    if x > (a + 1.0) / (a + b + 2.0):
        return 1.0 - beta_share(b, a, 1.0 - x)
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)) / a
    f, c, d = 1.0, 1.0, 0.0
    for i in range(400):
        m = i // 2
        if i == 0:
            numerator = 1.0
        elif i % 2 == 0:
            numerator = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        else:
            numerator = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        d = 1.0 / (1.0 + numerator * d)
        c = 1.0 + numerator / c
        f *= c * d
        if abs(c * d - 1.0) < 1e-16:
            break
    return front * (f - 1.0)


def t_p(t, df):
    return beta_share(df / 2.0, 0.5, df / (df + t * t))


def f_p(f, df1, df2):
    return beta_share(df2 / 2.0, df1 / 2.0, df2 / (df2 + df1 * f))


def covariance(rows):
    n, k = len(rows), len(rows[0])
    means = [mean([r[j] for r in rows]) for j in range(k)]
    return means, [[sum((r[i] - means[i]) * (r[j] - means[j]) for r in rows) / (n - 1) for j in range(k)] for i in range(k)]


def anova(rows):
    """F, its uncorrected p, epsilon of Greenhouse and Geisser and its p, from the double-centred covariance."""
    n, k = len(rows), len(rows[0])
    means, s = covariance(rows)
    row = [mean(r) for r in s]
    grand = mean(row)
    centred = [[s[i][j] - row[i] - row[j] + grand for j in range(k)] for i in range(k)]
    trace = sum(centred[i][i] for i in range(k))
    epsilon = trace * trace / ((k - 1) * sum(v * v for r in centred for v in r))
    f = n * sum((m - mean(means)) ** 2 for m in means) / trace
    return f, f_p(f, k - 1, (k - 1) * (n - 1)), epsilon, f_p(f, epsilon * (k - 1), epsilon * (k - 1) * (n - 1))


def friedman(rows):
    n, k = len(rows), len(rows[0])
    sums, ties = [0.0] * k, 0.0
    for row in rows:
        for j, value in enumerate(row):
            sums[j] += sum(v < value for v in row) + (1 + row.count(value)) / 2.0
        ties += sum(row.count(v) ** 3 - row.count(v) for v in set(row))
    return 12.0 * sum((s - n * (k + 1) / 2.0) ** 2 for s in sums) / (n * k * (k + 1) - ties / (k - 1))


def pairs(rows):
    """mean difference, t, p, Holm's p, d_z of each pair."""
    n, found = len(rows), []
    for a, b in itertools.combinations(range(len(rows[0])), 2):
        differences = [r[a] - r[b] for r in rows]
        d_z = mean(differences) / statistics.stdev(differences)
        found.append([mean(differences), d_z * math.sqrt(n), t_p(d_z * math.sqrt(n), n - 1), None, d_z])
    largest = 0.0
    for i, pair in enumerate(sorted(found, key=lambda p: p[2])):
        largest = max(largest, min(1.0, (len(found) - i) * pair[2]))
        pair[3] = largest
    return found


def holm_power(rows, test, subjects, draws, seed):
    """The share of simulated studies in which Holm's procedure shows pair `test`."""
    means, s = covariance(rows)
    k, rng = len(means), random.Random(seed)
    root = [[0.0] * k for _ in range(k)]
    for i in range(k):
        for j in range(i + 1):
            rest = s[i][j] - sum(root[i][m] * root[j][m] for m in range(j))
            root[i][j] = math.sqrt(max(rest, 0.0)) if i == j else (rest / root[j][j] if root[j][j] > 0 else 0.0)
    shown = 0
    for _ in range(draws):
        drawn = []
        for _ in range(subjects):
            z = [rng.gauss(0.0, 1.0) for _ in range(k)]
            drawn.append([means[i] + sum(root[i][m] * z[m] for m in range(i + 1)) for i in range(k)])
        shown += pairs(drawn)[test][3] < 0.05
    return shown / draws


def check(what, got, wanted, tolerance=1e-9):
    if not math.isclose(float(got), wanted, rel_tol=tolerance, abs_tol=1e-12):
        sys.exit(f"{what}: {got}, but {wanted} was computed")


def require(holds, what):
    if not holds:
        sys.exit(what)


def score(name, forms):
    if name == "tlx":
        return mean([forms["nasa-tlx"][n] for n in TLX])
    if name == "sus":
        odd = sum(forms["sus"][n] - 1 for n in SUS[0::2])
        return 2.5 * (odd + sum(5 - forms["sus"][n] for n in SUS[1::2]))
    trust = forms["trust"]
    return (trust["t1"] + (8 - trust["t2"]) + trust["t3"]) / 3.0


def check_trials(study, folder):
    with open(folder / "trials.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    with open(folder / "codebook.csv", newline="") as file:
        book = list(csv.DictReader(file))
    require([line["column"] for line in book] == list(rows[0]), "the codebook has not exactly the columns of trials.csv")
    require(len({line["column"] for line in book}) == len(book), "a column occurs twice")
    for line in book:
        require(line["meaning"] and line["source"] and line["missing"], f"the codebook says too little of {line}")
    wanted = [(name, trial) for name, trials in sorted(study.trials.items()) for trial in trials if name != "S07"]
    require(len(wanted) == 12 + 1 + 1 and len(rows) == len(wanted), f"{len(rows)} rows, {len(wanted)} trials")
    for row, (name, trial) in zip(rows, wanted):
        what = f"{name} {trial['step']}"
        require((row["participant"], row["method"], row["layout"], row["rotation_deg"]) ==
                (name, trial["method"], trial["layout"], str(trial["rotation"])), f"{what}: {row}")
        require(row["included"] == ("yes" if name <= "S04" else "no"), f"{what}: included {row['included']}")
        require(row["demographics_remark"] == REMARK.replace("\n", " "), f"{what}: {row['demographics_remark']}")
        require(row["demographics_games"] == "go; chess" and row["consent_agree"] == "yes", what)
        require((folder / row["file"]).is_file(), f"{what}: no file {row['file']}")
        for key in ("low_level_steps", "cell_moves", "pictures", "image_bytes", "guidance", "mapping_accuracy", "cell_accuracy", "edits",
                    "duration_s", "goals_reached"):
            check(f"{what} {key}", row[key], trial[key])
        check(f"{what} image_mib", row["image_mib"], trial["pictures"] * 180.0 / 1024.0)
        if trial["forms"]:
            for name_of_score in ("tlx", "sus", "trust"):
                check(f"{what} {name_of_score}", row[name_of_score], score(name_of_score, trial["forms"]))
            check(f"{what} item", row["nasa_tlx_effort"], trial["forms"]["nasa-tlx"]["effort"])
            require(row["attention_passed"] == ("yes" if trial["forms"]["nasa-tlx"]["check"] == 3 else "no"), what)
        else:
            require(row["tlx"] == "" and row["attention_passed"] == "", f"{what}: a score without answers")


def table(study, key, names):
    value = lambda trial: score(key, trial["forms"]) if key in ("tlx", "sus", "trust") else trial[key]
    return [[next(value(t) for t in study.trials[name] if t["method"] == m) for m in METHODS] for name in names]


def check_tests(study, report, names):
    for key in ("low_level_steps", "pictures", "mapping_accuracy", "duration_s", "tlx", "sus", "trust"):
        rows = table(study, key, names)
        test = report["tests"][key]["by_method"]["analysis"]
        require(test["subjects"] == names, f"{key}: of {test['subjects']}")
        f, p, epsilon, corrected = anova(rows)
        check(f"{key} F", test["anova"]["f"], f)
        check(f"{key} p", test["anova"]["p"], p, 1e-7)
        check(f"{key} epsilon", test["anova"]["greenhouse_geisser"]["epsilon"], epsilon)
        check(f"{key} corrected p", test["anova"]["greenhouse_geisser"]["p"], corrected, 1e-7)
        check(f"{key} Friedman", test["friedman"]["chi_squared"], friedman(rows))
        for got, wanted in zip(test["pairs"], pairs(rows)):
            for name, value in zip(("mean_difference", "t", "p", "p_holm", "d_z"), wanted):
                check(f"{key} {got['first']} - {got['second']} {name}", got[name], value, 1e-7)
        for j, method in enumerate(METHODS):
            means = report["measures"][key]["methods"][method]
            check(f"{key} {method} mean", means["mean"], mean([r[j] for r in rows]))
            check(f"{key} {method} SD", means["sd"], statistics.stdev([r[j] for r in rows]))
    by_position = report["tests"]["duration_s"]["by_position"]["analysis"]["conditions"]
    for place in range(3):
        check("place", by_position[place]["mean"], mean([study.trials[n][place]["duration_s"] for n in names]))


def check_power(study, report, names):
    plan = report["tests"]["low_level_steps"]["sample_size"]
    rows = table(study, "low_level_steps", names)
    for test, pair in enumerate(plan["pairs"]):
        subjects = pair["holm"]["power_0_8"]
        require(subjects is not None and subjects <= pair["holm"]["power_0_9"], f"{pair}")
        if subjects > 40:
            continue
        power = holm_power(rows, test, subjects, 3000, 5)
        require(power > 0.76, f"{pair['first']} - {pair['second']}: {subjects} participants have a power of {power}")
        if subjects > 2:
            power = holm_power(rows, test, subjects - 1, 3000, 6)
            require(power < 0.84, f"{pair['first']} - {pair['second']}: {subjects - 1} participants have a power of {power} already")


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(folder, ignore_errors=True)
    here = folder / "study-made-up"
    study = Study(here, 20)
    orders = [METHODS, METHODS[::-1], [METHODS[i] for i in (1, 0, 2)], [METHODS[i] for i in (2, 0, 1)]]
    for i, order in enumerate(orders):
        study.participant(f"S0{i + 1}", order)
    study.participant("S05", METHODS, stop="ig-mcts")
    study.participant("S06", METHODS, stop="instruction", aborted=True)
    study.participant("S07", METHODS)
    cut = here / "S07" / "result.json"
    cut.write_text(cut.read_text()[:200])

    def run(*arguments):
        return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)

    ended = run(here, "--json", folder / "a.json", "--power", "low_level_steps")
    require(ended.returncode == 1, f"exit code {ended.returncode} with a malformed file: {ended.stderr}")
    require("S07/result.json" in ended.stderr, f"the malformed file is not named: {ended.stderr}")
    report = json.loads((folder / "a.json").read_text())
    require([p["state"] for p in report["participants"]] == ["complete"] * 4 + ["incomplete", "aborted", "malformed"], str(report["participants"]))
    require("fire alarm" in report["participants"][5]["reason"] and "SYNTHETIC" in report["note"], str(report["participants"][5]))
    check_trials(study, here)
    names = ["S01", "S02", "S03", "S04"]
    check_tests(study, report, names)
    check_power(study, report, names)
    page = (here / "report.html").read_text()
    links = set(map(html.unescape, re.findall(r'href="([^"]+)"', page)))
    require({"trials.csv", "codebook.csv", "measures/tlx.csv", "S06/result.json", "S04/log.jsonl"} <= links, f"links: {sorted(links)}")
    for link in links:
        require((here / link).is_file(), f"the page links to {link}, which is no file")

    shutil.rmtree(here / "S07")
    ended = run(here, "--out", folder / "other", "--json", folder / "b.json", "--participants", "S01,S02,S04")
    require(ended.returncode == 0, f"exit code {ended.returncode}: {ended.stderr}")
    report = json.loads((folder / "b.json").read_text())
    check_tests(study, report, ["S01", "S02", "S04"])
    page = (folder / "other" / "report.html").read_text()
    for link in set(map(html.unescape, re.findall(r'href="([^"]+)"', page))):
        require((folder / "other" / link).is_file(), f"the page elsewhere links to {link}, which is no file")
    first = run(here, "--json", folder / "c.json").returncode, run(here, "--json", folder / "d.json").returncode
    require(first == (0, 0) and (folder / "c.json").read_bytes() == (folder / "d.json").read_bytes(), "two reports of one study differ")
    for wrong in ([folder / "none"], [folder], [here, "--participants", "S99"], [here, "--power", "beauty"], []):
        require(run(*wrong).returncode == 2, f"{wrong}: not refused")


main()
