#!/usr/bin/env bash
# missing_files_test.sh BIN_FOLDER: a named file that does not exist is wrong use (2) in every verb, and the message names it.
set -euo pipefail
bin=$(cd "$1" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
failures=0
while read -r program arguments; do
  code=0
  # shellcheck disable=SC2086  # words
  "$bin/$program" $arguments >output.txt 2>&1 </dev/null || code=$?
  ((code == 2)) && grep -q 'none\.file' output.txt && continue
  printf '%s %s: exit code %s\n%s\n' "$program" "$arguments" "$code" "$(cat output.txt)"
  failures=$((failures + 1))
done <<'ROWS'
conav demo --weights none.file
conav demo --map none.file
conav demo --operator none.file
conav-sim --config none.file
conav-nhpm --config none.file
conav-operator --config none.file
conav-planner --config none.file
conav-simulated-operator --config none.file
conav-recorder --config none.file
conav-driver --config none.file
conav-replay none.file
conav-explain none.file
conav-bag none.file
conav-token list --file none.file
conav-dataset synthesize --population none.file
conav-dataset describe none.file
conav-dataset import none.file --out set
conav-dataset export none.file
conav-dataset merge none.file --out set
conav-dataset split none.file --out-prefix set
conav-train --data none.file --out weights
conav-train --data none.file --adapt --base none.file --out weights
conav-evaluate --data none.file
conav-evaluate --data none.file --weights none.file
conav-export --weights none.file --onnx model.onnx
conav-experiment search --variants-file none.file
conav-experiment tradeoff --weights none.file
conav-study --population none.file
conav-study --weights none.file
conav-stats none.file
ROWS
((failures == 0))
