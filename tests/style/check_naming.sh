#!/usr/bin/env bash
# check_naming.sh ROOT BUILD: clang-tidy-14 finds every name in services/ and deploy/ as .clang-tidy wants it.
# Headers are seen through the sources that include them. A source is checked again only when its command, itself
# or a header of ours changed since the check before (stamps in BUILD/tidy).
set -euo pipefail
root=$(cd "$1" && pwd)
build=$(cd "$2" && pwd)
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mkdir -p "$build/tidy"

# All headers together are one key: a changed header checks everything again, which is safe and simple.
cd "$root"
mapfile -t headers < <("$here/list_sources.sh" "$root" '*.h' '*.idl' .clang-tidy)
headers_key=$(cat -- "${headers[@]}" | sha256sum)

sources=()
while read -r file; do
  # Only what this build compiles has a command to be checked with.
  if grep -qF "\"file\": \"$root/$file\"" "$build/compile_commands.json"; then sources+=("$file"); fi
done < <("$here/list_sources.sh" "$root" '*.cc' | grep -E '^(services|deploy)/')
((${#sources[@]} > 0)) || { echo "no sources in $build/compile_commands.json"; exit 1; }

check_one() {
  local file=$1 stamp key
  stamp=$build/tidy/${file//\//_}
  key="$headers_key $(sha256sum <"$file")"
  [[ -f $stamp && $(<"$stamp") == "$key" ]] && return 0
  clang-tidy-14 --quiet -p "$build" --extra-arg=-w --header-filter="^$root/(services|deploy)/" "$file" 2>/dev/null || return 1
  printf '%s' "$key" >"$stamp"
}
export -f check_one
export root build headers_key
# shellcheck disable=SC2016
printf '%s\0' "${sources[@]}" | xargs -0 -P 2 -n 1 bash -c 'check_one "$0"'
echo "${#sources[@]} sources are named as .clang-tidy says"
