#!/usr/bin/env bash
# check_includes.sh ROOT: who may include whom, see include_rules.awk.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mapfile -t files < <("$here/list_sources.sh" "$1" '*.h' '*.cc')
((${#files[@]} > 0)) || { echo "no sources below $1"; exit 1; }
cd "$1"
grep -HoE '^[[:space:]]*#[[:space:]]*include[[:space:]]*["<][^">]+' -- "${files[@]}" |
  sed -E 's/^([^:]+):.*["<]/\1 /' | awk -f "$here/include_rules.awk"
