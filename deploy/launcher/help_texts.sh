#!/usr/bin/env bash
# help_texts.sh [--update] BIN_FOLDER: compares the help texts of commands.txt with what the programs in BIN_FOLDER print;
# with --update writes what they print into commands.txt.
set -euo pipefail
commands_file=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/commands.txt
update=""
if [[ ${1-} == --update ]]; then
  update=yes
  shift
fi
bin=${1:?usage: help_texts.sh [--update] BIN_FOLDER}
current=$(mktemp)
trap 'rm -f "$current"' EXIT

by_hand=yes
while IFS= read -r line; do
  if [[ $line == "== "* ]]; then
    by_hand=yes
    printf '%s\n' "$line"
    if [[ $line == *" = "* ]]; then
      by_hand=""
      read -ra program <<<"${line#* = }"
      "$bin/${program[0]}" "${program[@]:1}" --help </dev/null
    fi
  elif [[ -n $by_hand ]]; then
    printf '%s\n' "$line"
  fi
done <"$commands_file" >"$current"

if [[ -n $update ]]; then
  cat "$current" >"$commands_file"
elif ! diff -u "$commands_file" "$current"; then
  echo "The help texts changed; deploy/launcher/help_texts.sh --update $bin writes the new ones." >&2
  exit 1
fi
