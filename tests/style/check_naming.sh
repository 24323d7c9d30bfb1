#!/usr/bin/env bash
# check_naming.sh ROOT BUILD: clang-tidy-14 finds every name in services/ and deploy/ as .clang-tidy wants it, and no function
# too long. The sources of a folder are read in one pass, as one file that includes them all; where they do not go
# together (two helpers of one name, other compiler options), each by itself. Headers are seen through the sources.
# What was clean is read again only when its command, itself or a header of ours changed (stamps in BUILD/tidy).
set -euo pipefail
root=$(cd "$1" && pwd)
build=$(cd "$2" && pwd)
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mkdir -p "$build/tidy"

# All headers together are one key: a changed header checks everything again, which is safe and simple.
cd "$root"
mapfile -t headers < <("$here/list_sources.sh" "$root" '*.h' '*.idl' .clang-tidy)
headers_key=$(cat -- "${headers[@]}" | sha256sum)

# Only what this build compiles has a command to be checked with.
mapfile -t sources < <("$here/list_sources.sh" "$root" '*.cc' | grep -E '^(services|deploy)/' |
  while read -r file; do ! grep -qF "\"file\": \"$root/$file\"" "$build/compile_commands.json" || printf '%s\n' "$file"; done)
((${#sources[@]} > 0)) || { echo "no sources in $build/compile_commands.json"; exit 1; }

# tidy FILE [OPTIONS]: clang-tidy over one file, its complaints on standard output.
tidy() {
  local file=$1
  shift
  clang-tidy-14 --quiet --config-file="$root/.clang-tidy" --extra-arg=-w --header-filter="^$root/(services|deploy)/" "$file" "$@" 2>/dev/null
}

# flags FILE: the compiler options of a source, one a line, without input and output.
flags() {
  grep -F -B 1 "\"file\": \"$root/$1\"" "$build/compile_commands.json" | sed -n 's/.*"command": "\(.*\)",*$/\1/p' | head -n 1 |
    sed 's/\\\(.\)/\1/g' | xargs -n 1 printf '%s\n' | awk 'NR == 1 || $0 == "-c" {next} $0 == "-o" {skip = 1; next} skip {skip = 0; next} !/\.cc$/'
}

# check_group FILE...: sources of one folder, together if they go together.
check_group() {
  local stamp key group code=0 file options
  stamp=$build/tidy/${1//\//_}
  key="$headers_key $(cat -- "$@" | sha256sum) $#"
  [[ -f $stamp && $(<"$stamp") == "$key" ]] && return 0
  if (($# > 1)); then
    group=$build/tidy/group_${1//\//_}
    for file in "$@"; do printf '#include "%s/%s"\n' "$root" "$file"; done >"$group"
    mapfile -t options < <(for file in "$@"; do flags "$file"; done)
    options+=(-w)
    if tidy "$group" -- "${options[@]}" >"$group.txt"; then
      printf '%s' "$key" >"$stamp"
      return 0
    fi
    for file in "$@"; do check_group "$file" || code=1; done
  else
    tidy "$1" -p "$build" || code=1
  fi
  ((code == 0)) && printf '%s' "$key" >"$stamp"
  return $code
}
export -f check_group tidy flags
export root build headers_key
# A group a line: the sources of a folder, and its program if it has one only.
# shellcheck disable=SC2016
printf '%s\n' "${sources[@]}" |
  awk '{folder = $0; sub(/\/[^\/]*$/, "", folder)
        if ($0 ~ /main\.cc$/ && has_main[folder]++) print; else group[folder] = group[folder] " " $0}
       END {for (folder in group) print substr(group[folder], 2)}' |
  awk '{print length($0) "\t" $0}' | sort -rn | cut -f 2- |
  xargs -P 2 -I{} bash -c 'read -r -a files <<<"{}"; check_group "${files[@]}"'
echo "${#sources[@]} sources are named as .clang-tidy says"
