#!/usr/bin/env bash
# check_structure.sh ROOT: how many rooms the house has. Prints the figures of services/ and deploy/ (production) and of
# tests/, and refuses what is over the limits below. A header that only one file includes is a part of that file, or says
# why it is not in a line "// One user: <reason>".
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# Raised from 70000 and 42000 lines for the experiments with scenarios, strangers and Python, and from 75500 and 43000 for
# ROS 2: its services and actions, the driver of real robots, Foxglove. Their topics stand apart from what needs no bus, in
# headers with one user. From 84500 and 48000 for several hosts: security, tokens, restarts and checkpoints, lossy links. From 88500
# and 53000 for the soak, hosts.yaml and its doctor, sweeps, and eye tracking. From 93500 and 54500 for the study with people: its
# protocol, steps and forms, the eye tracker's client, and the report.
readonly most_lines=100000 most_files=587 most_folders=45 least_median=100 most_one_user=18 most_test_lines=58000 longest_function=60
mapfile -t production < <("$here/list_sources.sh" "$1" '*.h' '*.cc' | grep -E '^(services|deploy)/')
mapfile -t tests < <("$here/list_sources.sh" "$1" '*.h' '*.cc' | grep -E '^tests/')
((${#production[@]} > 0)) || { echo "no sources below $1"; exit 1; }
cd "$1"
failures=0
# figure NAME VALUE RELATION LIMIT: prints it, and whether it holds (-le or -ge).
figure() {
  local good=good
  test "$2" "$3" "$4" || { good="OVER THE LIMIT"; failures=$((failures + 1)); }
  printf '%-52s %7s   %s %s  %s\n' "$1" "$2" "$([[ $3 == -le ]] && echo 'at most ' || echo 'at least')" "$4" "$good"
}

figure "production C++: lines" "$(cat -- "${production[@]}" | wc -l)" -le $most_lines
figure "production C++: files" "${#production[@]}" -le $most_files
figure "production C++: folders" "$(printf '%s\n' "${production[@]}" | sed 's|/[^/]*$||' | sort -u | wc -l)" -le $most_folders
median=$(for file in "${production[@]}"; do wc -l <"$file"; done | sort -n | awk '{l[NR] = $1} END {print l[int((NR + 1) / 2)]}')
figure "production C++: lines of the median file" "$median" -ge $least_median
# clang-format puts the braces of a function of a source at the left edge.
# shellcheck disable=SC2016
longest=$(awk '  FNR == 1 {start = 0}
  /^[A-Za-z~].*[{]$/ && /\(/ && !/^(namespace|class|struct|enum|union|extern)/ {start = FNR; next}
  /^( {4,}|\) ).*[{]$/ && !start && pending {start = pending; next}
  {pending = /^[A-Za-z].*[(,]$/ ? FNR : (/^ / ? pending : 0)}
  /^}/ && start {if (FNR - start - 1 > most) {most = FNR - start - 1; where = FILENAME ":" start}; start = 0}
  END {print most + 0, where}' "${production[@]}")
figure "production C++: lines of the longest function" "${longest%% *}" -le $longest_function
echo "  (${longest#* })"

# Includes are written from services/ or deploy/.
mapfile -t headers < <(printf '%s\n' "${production[@]}" | grep '\.h$')
one_user=$({ grep -HoE '^#include "[^"]+"' -- "${production[@]}" || true; } | sed -E 's/^([^:]+):#include "(.*)"$/\1 \2/' |
  awk '{own = $1; sub(/^[a-z]+\//, "", own); sub(/\.(h|cc)$/, "", own); user = $2; sub(/\.h$/, "", user)
        if (own != user) users[$2]++}
       END {for (header in users) if (users[header] == 1) print header}' | sort)
count=0
while read -r header; do
  [[ -n $header ]] || continue
  for folder in services deploy; do
    [[ -f $folder/$header ]] || continue
    count=$((count + 1))
    grep -q '^// One user: ' "$folder/$header" || {
      printf '%s: one file includes it: make it a part of that file, or say why not\n' "$folder/$header"
      failures=$((failures + 1))
    }
  done
done <<<"$one_user"
figure "production C++: headers with one user, percent" $((100 * count / (${#headers[@]} > 0 ? ${#headers[@]} : 1))) -le $most_one_user
[[ ${#tests[@]} -eq 0 ]] || figure "test C++: lines" "$(cat -- "${tests[@]}" | wc -l)" -le $most_test_lines
((failures == 0))
