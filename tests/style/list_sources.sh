#!/usr/bin/env bash
# list_sources.sh ROOT [PATTERN...]: the tracked files below ROOT, one per line, that match a pattern ('*.h').
# Outside of a git checkout: all files but those of build/ and runs/.
set -euo pipefail
cd "$1"
shift
if [[ $(git rev-parse --show-toplevel 2>/dev/null || true) == "$PWD" ]]; then
  # A file that was moved away and not committed yet is still listed by git.
  git ls-files -- "$@" | while read -r file; do [[ ! -f $file ]] || printf '%s\n' "$file"; done
else
  names=()
  for pattern in "$@"; do names+=(-o -name "$pattern"); done
  find . -type d \( -name build -o -name runs -o -name .git \) -prune -o -type f \( -false "${names[@]}" \) -print |
    sed 's|^\./||' | sort
fi
