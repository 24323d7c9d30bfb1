#!/usr/bin/env python3
"""check_naming.py ROOT: every name that services/ and deploy/ declare in C++ is
written as its kind is, by what universal-ctags reads."""

import json
import re
import subprocess
import sys
from pathlib import Path

# What each kind of name looks like. Methods may be called as those of the standard library are.
CAMEL = "[A-Z][A-Za-z0-9]*"
LOWER = "[a-z][a-z0-9_]*"
CONSTANT = "k" + CAMEL
STYLES = {kind: CAMEL for kind in ("class", "struct", "enum", "union", "function", "prototype")}
STYLES |= {kind: LOWER for kind in ("local", "parameter", "variable", "externvar", "member", "namespace")}
STYLES |= {"enumerator": CONSTANT, "typedef": f"{CAMEL}|{LOWER}"}


def read_names(root):
    """All names that the sources below root declare: one dict each."""
    tracked = subprocess.run([Path(__file__).parent / "list_sources.sh", root, "*.h", "*.cc"],
                             check=True, capture_output=True, text=True).stdout
    sources = "\n".join(file for file in tracked.splitlines() if file.startswith(("services/", "deploy/")))
    options = ["--languages=C++", "--langmap=C++:.h.cc", "--output-format=json", "--fields=+an", "--fields-C++=+{properties}",
               "--kinds-C++=cefglmnpstuvxz"]
    listed = subprocess.run(["ctags", *options, "-L", "-", "-f", "-"],
                            check=True, input=sources, capture_output=True, text=True, cwd=root).stdout
    return [tag for tag in map(json.loads, listed.splitlines()) if tag["_type"] == "tag"]


def is_others(tag, line):
    """Whether the name is not ours to choose, or none at all."""
    name, kind = tag["name"], tag["kind"]
    if not re.fullmatch(r"\w+", name) or name.startswith("__anon"):
        return True
    if kind == "function" and (name == "main" or "override" in tag.get("properties", "") or re.fullmatch(r"[A-Z0-9_]+", name)):
        return True  # a library's, or the use of a macro
    if kind == "struct" and re.search(rf"\b{name}<|struct stat ", line):
        return True  # a library's template made ours
    # In a body, ctags takes a variable made with (...) for a function.
    is_body = kind == "prototype" and (tag["path"].endswith(".cc") or "." in line.split("(")[0])
    return is_body or "NOLINT" in line


def style_of(tag, line):
    """The pattern that the name must fit."""
    name, kind = tag["name"], tag["kind"]
    if kind in ("local", "variable", "member") and re.search(rf"\bconstexpr\b[^(]*\b{name}\b", line):
        return CONSTANT
    if kind == "member" and tag.get("access") in ("private", "protected"):
        return LOWER + "_"
    if kind in ("function", "prototype") and tag.get("scopeKind") in ("class", "struct"):
        return f"{CAMEL}|{LOWER}"
    return STYLES[kind]


def main():
    root = Path(sys.argv[1]).resolve()
    names = read_names(root)
    wrong = []
    for tag in names:
        line = tag["pattern"][2:-2]
        if not is_others(tag, line) and not re.fullmatch(style_of(tag, line), tag["name"]):
            wrong.append(f"{tag['path']}:{tag['line']}: {tag['kind']} {tag['name']} should be like {style_of(tag, line)}")
    print("\n".join([*wrong, f"{len(names)} names, {len(wrong)} wrong"]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
