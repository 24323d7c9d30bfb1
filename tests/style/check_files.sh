#!/usr/bin/env bash
# check_files.sh ROOT: file names are snake_case (but of ROS 2 messages), no file is over 500 lines, headers begin with #pragma once,
# every C++ test is built (a CMakeLists.txt names it), no test has a semicolon in its name (ctest makes two of such a name, which match no test and pass), and numeric options
# are bounded by Between of common/cli: CLI::Range lets nan through.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
readonly line_limit=500
mapfile -t files < <("$here/list_sources.sh" "$1" '*.h' '*.cc' '*.idl' '*.sh')
((${#files[@]} > 0)) || { echo "no sources below $1"; exit 1; }
cd "$1"
failures=0
refuse() {
  printf '%s: %s\n' "$1" "$2"
  failures=$((failures + 1))
}
for file in "${files[@]}"; do
  name=${file##*/}
  [[ $file == idl/conav_msgs/*/* || $name =~ ^[a-z][a-z0-9_]*\.(h|cc|idl|sh)$ ]] || refuse "$file" "is not named in snake_case"
  [[ $file != *.h ]] || { read -r first <"$file" && [[ $first == "#pragma once" ]]; } || refuse "$file" "does not begin with #pragma once"
done
while read -r lines file; do
  ((lines <= line_limit)) || refuse "$file" "has $lines lines; $line_limit is the limit"
done < <(printf '%s\0' "${files[@]}" | xargs -0 grep -c '' /dev/null | sed 's/\(.*\):\(.*\)/\2 \1/')
while read -r file; do
  [[ $file != *.cc ]] || refuse "$file" "has a test with a semicolon in its name"
done < <(printf '%s\0' "${files[@]}" | xargs -0 grep -lE 'TEST_CASE\("[^"]*;' || true)
while read -r file; do
  [[ $file == services/common/cli/cli.h || $file == *.sh ]] || refuse "$file" "has CLI::Range: use Between"
done < <(printf '%s\0' "${files[@]}" | xargs -0 grep -l 'CLI::Range(' || true)
# is_built FILE: a CMakeLists.txt above it names it.
is_built() {
  local folder=${1%/*}
  while [[ $folder == tests* ]]; do
    [[ ! -e $folder/CMakeLists.txt ]] || ! sed '/^ *#/d' "$folder/CMakeLists.txt" | grep -wF -- "${1#"$folder"/}" >/dev/null || return 0
    [[ $folder == */* ]] || return 1
    folder=${folder%/*}
  done
  return 1
}
for file in "${files[@]}"; do
  [[ $file != tests/*_test.cc ]] || is_built "$file" || refuse "$file" "is in no CMakeLists.txt: it never runs"
done
echo "${#files[@]} files, $failures refused"
((failures == 0))
