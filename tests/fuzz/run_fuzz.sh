#!/usr/bin/env bash
# run_fuzz.sh PROGRAM SEEDS FOLDER SECONDS: runs a fuzz program from SEEDS, and SEEDS.tar.gz of nights, for so long. An input that breaks it is left in
# FOLDER, and `PROGRAM INPUT` breaks again (of file_fuzz with CONAV_FUZZ_READER, which is the name of SEEDS). With
# CONAV_FUZZ_RUNS=N the program runs N inputs instead.
set -euo pipefail
program=$1 seeds=$2 folder=$3 seconds=$4
limit=(-max_total_time="$seconds")
[[ -z ${CONAV_FUZZ_RUNS-} ]] || limit=(-runs="$CONAV_FUZZ_RUNS")
CONAV_FUZZ_READER=$(basename "$seeds")
export CONAV_FUZZ_READER
rm -rf "$folder/corpus"
mkdir -p "$folder/corpus"
[[ ! -e $seeds.tar.gz ]] || tar -xzf "$seeds.tar.gz" -C "$folder/corpus"
# AddressSanitizer of clang 14 does not find room for its memory where addresses are randomised widely.
fixed=()
setarch "$(uname -m)" -R true 2>/dev/null && fixed=(setarch "$(uname -m)" -R)
# Where memory came from is kept in two frames: libraries without frame pointers give another stack each time, and soon
# finding a stack takes half the time. PROGRAM INPUT has them whole.
export ASAN_OPTIONS=malloc_context_size=2
exec "${fixed[@]}" "$program" -seed="${CONAV_FUZZ_SEED-1}" "${limit[@]}" -max_len=4096 -timeout=20 -rss_limit_mb=2048 \
  -print_final_stats=1 -artifact_prefix="$folder/" "$folder/corpus" "$seeds"
