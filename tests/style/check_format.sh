#!/usr/bin/env bash
# check_format.sh ROOT: every C++ file is as clang-format-14 would write it.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mapfile -t files < <("$here/list_sources.sh" "$1" '*.h' '*.cc')
((${#files[@]} > 0)) || { echo "no sources below $1"; exit 1; }
cd "$1"
printf '%s\0' "${files[@]}" | xargs -0 -P 2 -n 40 clang-format-14 --dry-run -Werror --style=file
echo "${#files[@]} files are formatted"
