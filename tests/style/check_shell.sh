#!/usr/bin/env bash
# check_shell.sh ROOT: shellcheck has nothing to say about our scripts.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mapfile -t files < <("$here/list_sources.sh" "$1" '*.sh')
cd "$1"
for file in conav .ci/run; do [[ ! -f $file ]] || files+=("$file"); done
shellcheck "${files[@]}"
echo "${#files[@]} scripts are clean"
