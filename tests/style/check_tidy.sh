#!/usr/bin/env bash
# check_tidy.sh ROOT BUILD: clang-tidy-14 finds every name in services/ and deploy/ as .clang-tidy wants it, and no function too
# long: what check_naming.py and check_structure.sh find in seconds but for what they guess wrong. It reads what BUILD compiles, several sources together where the compiler does; headers are seen through them.
# What was clean is read again only when itself or a header of ours changed (stamps in BUILD/tidy).
set -euo pipefail
root=$(cd "$1" && pwd)
build=$(cd "$2" && pwd)
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mkdir -p "$build/tidy"

# All headers together are one key: a changed header checks everything again, which is safe and simple.
cd "$root"
mapfile -t headers < <("$here/list_sources.sh" "$root" '*.h' '*.idl' .clang-tidy)
headers_key=$(cat -- "${headers[@]}" | sha256sum)
ours="^($root|$build)/(services|deploy)/"

mapfile -t units < <(sed -n 's/^ *"file": "\(.*\)".*/\1/p' "$build/compile_commands.json" | grep -E "$ours" | sort -u)
((${#units[@]} > 0)) || { echo "no sources in $build/compile_commands.json"; exit 1; }

# sources UNIT: the sources that it is made of.
sources() {
  case $1 in
    */Unity/unity_*) sed -n 's/^#include "\(.*\)"$/\1/p' "$1" ;;
    *) printf '%s\n' "$1" ;;
  esac
}

check() {
  local stamp=$build/tidy/${1//\//_} key files
  mapfile -t files < <(sources "$1")
  key="$headers_key $(cat -- "${files[@]}" | sha256sum)"
  [[ -f $stamp && $(<"$stamp") == "$key" ]] && return
  clang-tidy-14 --quiet --config-file="$root/.clang-tidy" --extra-arg=-w --header-filter="$ours" -p "$build" "$1" 2>/dev/null || return
  printf '%s' "$key" >"$stamp"
}
export -f check sources
export root build ours headers_key
# The largest first.
for unit in "${units[@]}"; do
  mapfile -t files < <(sources "$unit")
  printf '%d %s\n' "$(cat -- "${files[@]}" | wc -l)" "$unit"
done | sort -rn | cut -d ' ' -f 2 | xargs -P 2 -I{} bash -c 'check {}'
echo "${#units[@]} compilations are named as .clang-tidy says"
