"""Runs what the figures of README and docs come from, and writes them down: reproduce.json and reproduce.html.

What there is to run is a list, reproduce_items.json beside this file; each item has
  name       of the item, and the first word of its figures' keys
  commands   verbs of ./conav with arguments; {dir} is the item's folder, {json} the file that figures are read from; a word with *
             becomes the files that there are
  quick      the same with less work
  seeds      commands with {seed} are run for each; with --quick for the first. {dir}/NAME-{seed}.json holds what they print,
             and of each figure there are NAME.KEY.mean, .min, .max and .sum over the seeds
  row_names  fields that name the elements of lists in {json}; others are numbered
  figures    which of the numbers are kept, as patterns like methods.*.steps_mean ("*" keeps all)
  kept       file of the project that is {json} of the last run; without it figures are in docs/data/reproduce.json
  texts      {page: [lines]}: what the page prints, with {key:format} where a figure stands; lines that differ in words are
             one, {"line": "$1 has {$2.steps:.0f}", "rows": [["A", "a"], ["B", "b"]]}. A test compares pages with the last run.
An item that was run before by the same commands and code is not run again.
"""
from __future__ import annotations

import argparse
import fnmatch
import glob
import hashlib
import html
import json
import os
import re
import shlex
import shutil
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Dict, Iterator, List, Sequence, Tuple

from . import Error

ITEMS = Path(__file__).resolve().parent / "reproduce_items.json"


def numbers(value: Any, row_names: Sequence[str], path: str = "") -> Iterator[Tuple[str, float]]:
    """The numbers of a JSON document by their paths, with dots between keys."""
    if isinstance(value, bool) or isinstance(value, (int, float)):
        yield path, float(value)
        return
    parts: List[Tuple[str, Any]] = []
    if isinstance(value, dict):
        parts = [(str(key), part) for key, part in value.items()]
    elif isinstance(value, list):
        for index, part in enumerate(value):
            names = [str(part[name]) for name in row_names if name in part] if isinstance(part, dict) else []
            parts.append((".".join(names) or str(index), part))
    for key, part in parts:
        yield from numbers(part, row_names, f"{path}.{key}" if path else key)


def over_seeds(item: Dict[str, Any], folder: Path) -> Dict[str, float]:
    """Means, extremes and sums over NAME-SEED.json in the folder, by NAME."""
    values: Dict[str, List[float]] = {}
    for seed in item.get("seeds", []):
        for file in sorted(folder.glob(f"*-{seed}.json")):
            for key, value in numbers(json.loads(file.read_text()), item.get("row_names", [])):
                values.setdefault(f"{file.stem[:-len(str(seed)) - 1]}.{key}", []).append(value)
    found = {}
    for key, of_seeds in values.items():
        found.update({f"{key}.mean": statistics.fmean(of_seeds), f"{key}.min": min(of_seeds), f"{key}.max": max(of_seeds), f"{key}.sum": sum(of_seeds)})
    return found


def figures_of(item: Dict[str, Any], file: Path) -> Dict[str, float]:
    if not item.get("figures"):
        return {}
    found = over_seeds(item, file.parent)
    if file.exists() or not found:
        found.update(numbers(json.loads(file.read_text()), item.get("row_names", [])))
    kept = {key: value for key, value in found.items() if any(fnmatch.fnmatchcase(key, wanted) for wanted in item["figures"])}
    if not kept:
        raise Error(f"{item['name']}: {file.parent} has none of the figures {item['figures']}")
    return kept


def text_with(template: str, figures: Dict[str, float]) -> str:
    """The template with figures in place of {key:format}. Throws Error that names the key.

    Formats are Python's, but "%" makes percent without the sign, "MiB" divides bytes, and "part" is " (96 %)" of what is not 1.
    """

    def value(match: "re.Match[str]") -> str:
        key, form = match.group(1), match.group(2)
        if key not in figures:
            raise Error(f"no figure {key}")
        if form == "part":
            return "" if figures[key] == 1.0 else f" ({100 * figures[key]:.0f} %)"
        if form == "MiB":
            return format(figures[key] / 2**20, ".1f")
        if form.endswith("%"):
            return format(100 * figures[key], form[:-1] + "f")
        return format(int(figures[key]) if form.endswith("d") else figures[key], form)

    return re.sub(r"\{([^{}:]+):([^{}]*)\}", value, template)


def lines_of(templates: Sequence[Any]) -> Iterator[str]:
    """The templates, those with rows once for each row."""
    for template in templates:
        if isinstance(template, str):
            yield template
            continue
        for row in template["rows"]:
            yield re.sub(r"\$(\d)", lambda place: str(row[int(place.group(1)) - 1]), template["line"])


def differences(items: Sequence[Dict[str, Any]], done: Dict[str, Any], root: Path) -> List[str]:
    """What pages print otherwise than the figures say."""
    wrong = []
    for item in items:
        figures = done.get(item["name"], {}).get("figures", {})
        if not figures and "kept" in item:
            figures = figures_of(item, root / item["kept"])
        for page, templates in item.get("texts", {}).items():
            content = " ".join((root / page).read_text().split())
            for template in lines_of(templates):
                try:
                    text = text_with(template, figures)
                except Error as error:
                    wrong.append(f"{page}: {error} for: {template} (./conav reproduce --only {item['name']})")
                    continue
                if " ".join(text.split()) not in content:
                    wrong.append(f"{page} does not print: {text}")
    return wrong


def words_of(command: str, folder: Path, seed: Any) -> List[str]:
    """The command's words with places filled in; one with * becomes the files that there are."""
    words = []
    for word in shlex.split(command):
        for place, text in {"{dir}": str(folder), "{json}": str(folder / "result.json"), "{seed}": str(seed)}.items():
            word = word.replace(place, text)
        words += sorted(glob.glob(word)) if "*" in word else [word]
    return words


def run_item(item: Dict[str, Any], commands: Sequence[str], root: Path, folder: Path, seeds: Sequence[Any]) -> Dict[str, Any]:
    folder.mkdir(parents=True, exist_ok=True)
    output, start = "", time.monotonic()
    for command, seed in [(command, seed) for command in commands for seed in (seeds if "{seed}" in command else [None])]:
        words = [str(root / "conav"), *words_of(command, folder, seed)]
        done = subprocess.run(words, cwd=root, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
        output += done.stdout
        if done.returncode not in item.get("exit_codes", [0]):
            raise Error(f"{item['name']}: ./conav {command}: exit code {done.returncode}\n{done.stderr[-2000:]}")
    return {"command": " && ".join(f"./conav {command}" for command in commands), "seconds": round(time.monotonic() - start, 1),
            "figures": figures_of(item, folder / "result.json"), "output": output}


def page_of(items: Sequence[Dict[str, Any]], results: Dict[str, Any], wrong: Sequence[str], version: str) -> str:
    parts = ["<!doctype html><meta charset=utf-8><title>conav: all figures</title><style>body{font:15px/1.5 sans-serif;max-width:70em;"
             "margin:2em auto;padding:0 1em}pre{overflow:auto;background:#f4f4f4;padding:1em}td,th{padding:0 1em 0 0;text-align:left}"
             "svg{max-width:100%}</style><h1>All figures</h1>", f"<p>{html.escape(version)}; operators are SIMULATED.</p>"]
    parts += ["<h2>Pages that print something else</h2><ul>", *(f"<li>{html.escape(line)}" for line in wrong), "</ul>"] if wrong else []
    for item in items:
        result = results.get(item["name"])
        parts.append(f"<h2 id={item['name']}>{html.escape(item['name'])}</h2>")
        if result is None:
            parts.append("<p>Not run.</p>")
            continue
        parts.append(f"<p><code>{html.escape(result['command'])}</code><br>{result['seconds']} s, {html.escape(result['version'])}</p>")
        parts.append(f"<pre>{html.escape(result.get('output', ''))}</pre>")
        for drawing in sorted(Path(result["folder"]).glob("*.svg")):
            parts.append(drawing.read_text())
        rows = "".join(f"<tr><td>{html.escape(key)}<td>{value:g}" for key, value in result["figures"].items())
        parts.append(f"<details><summary>{len(result['figures'])} figures</summary><table>{rows}</table></details>")
    return "\n".join(parts)


def code_of(root: Path) -> str:
    """Changes with the programs and what comes with them, not with pages."""
    folders = ["services", "deploy", "idl", ":!services/study/python"]
    digest = hashlib.sha256()
    for words in (["ls-files", "-s"], ["diff", "HEAD"]):
        done = subprocess.run(["git", *words, "--", *folders], cwd=root, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
        digest.update(done.stdout)
    return digest.hexdigest()


def root_of_checkout() -> Path:
    for folder in [ITEMS.parent, Path.cwd(), *Path.cwd().parents, *ITEMS.parents]:
        if (folder / "conav").is_file() and (folder / "docs").is_dir():
            return folder
    raise Error("reproduce: runs in a checkout of conav")


def run(arguments: argparse.Namespace) -> int:
    root = root_of_checkout()
    items: List[Dict[str, Any]] = json.loads(ITEMS.read_text())
    names = [item["name"] for item in items]
    for name in arguments.only:
        if name not in names:
            raise Error(f"--only {name}: expected one of {', '.join(names)}")
    chosen = [item for item in items if not arguments.only or item["name"] in arguments.only]
    kind = "quick" if arguments.quick else "full"
    folder = Path(arguments.out or f"runs/reproduce-{kind}").resolve()
    folder.mkdir(parents=True, exist_ok=True)
    version = subprocess.run([str(root / "conav"), "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
    code = code_of(root)
    file = folder / "reproduce.json"
    results: Dict[str, Any] = json.loads(file.read_text())["items"] if file.exists() else {}
    failed = []
    for item in chosen:
        commands = item["quick"] if arguments.quick else item["commands"]
        before = results.get(item["name"], {})
        if before.get("commands") == commands and (before.get("code") == code or arguments.keep):
            try:
                before["figures"] = figures_of(item, folder / item["name"] / "result.json")
                print(f"{item['name']}: done before", file=sys.stderr)
                continue
            except (Error, OSError, ValueError):
                pass  # its file is gone
        print(f"{item['name']}: {' && '.join(commands)}", file=sys.stderr)
        begun_by = folder / item["name"] / "code"  # what is left of other code would be continued
        if begun_by.exists() and begun_by.read_text() != code and not arguments.keep:
            shutil.rmtree(begun_by.parent)
        begun_by.parent.mkdir(exist_ok=True)
        begun_by.write_text(code)
        try:
            seeds = item.get("seeds", [])[: 1 if arguments.quick else None]
            result = run_item(item, commands, root, folder / item["name"], seeds)
        except (Error, OSError, ValueError) as error:
            failed.append(item["name"])
            print(f"{item['name']}: {error}", file=sys.stderr)
            continue
        results[item["name"]] = {**result, "commands": commands, "version": version, "code": code, "folder": str(folder / item["name"])}
        temporary = folder / "reproduce.json.part"
        temporary.write_text(json.dumps({"version": version, "quick": arguments.quick, "items": results}, indent=1))
        os.replace(temporary, file)
        print(f"{item['name']}: {result['seconds']} s", file=sys.stderr)
    wrong = [] if arguments.quick else differences([item for item in chosen if item["name"] in results], results, root)
    (folder / "reproduce.html").write_text(page_of(items, results, wrong, version))
    if arguments.update:
        update(root, items, results)
    for line in wrong:
        print(line)
    print(f"{folder / 'reproduce.html'}: {len(results)} items, {len(failed)} failed, {len(wrong)} lines of pages differ")
    return 1 if failed or wrong else 0


def update(root: Path, items: Sequence[Dict[str, Any]], results: Dict[str, Any]) -> None:
    """Writes the figures of this run into docs/data/reproduce.json and the files that items keep; others stay."""
    file = root / "docs/data/reproduce.json"
    last: Dict[str, Any] = json.loads(file.read_text()) if file.exists() else {}
    for name, result in results.items():
        last[name] = {key: result[key] for key in ("command", "version", "seconds", "figures")}
    for item in items:
        if "kept" in item and item["name"] in results:
            del last[item["name"]]["figures"]
            shutil.copyfile(Path(results[item["name"]]["folder"]) / "result.json", root / item["kept"])
    file.write_text(json.dumps(dict(sorted(last.items())), indent=1) + "\n")


def add_command(commands: Any) -> None:
    command = commands.add_parser("reproduce", help="run what the figures of README and docs come from")
    command.add_argument("--quick", action="store_true", help="smaller: under 15 minutes on 2 cores; compares no page")
    command.add_argument("--out", metavar="DIR", help="runs/reproduce-full or runs/reproduce-quick; the same folder continues")
    command.add_argument("--only", nargs="+", default=[], metavar="NAME", help="only these items")
    command.add_argument("--keep", action="store_true", help="also keep what other code ran")
    command.add_argument("--update", action="store_true", help="write the figures into docs/data/reproduce.json, which a test compares with the pages")
    command.set_defaults(run=run)
