#!/usr/bin/env bash
# night.sh BUILD_FOLDER [RUNS]: gives each fuzz test of a build so many inputs (10 million), one test per core at a time, other
# ones each time, and keeps a small set that reaches all code reached so far in tests/fuzz/corpus/NAME.tar.gz. Takes a
# night. The first input that breaks a parser ends its test, which is named.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

# fuzz NAME PROGRAM: one of them.
fuzz() {
  local folder=$build/tests/fuzz/$1 broke=0
  CONAV_FUZZ_SEED=$RANDOM CONAV_FUZZ_RUNS=$runs "$here/run_fuzz.sh" "$2" "$here/corpus/$1" "$folder" 0 >"$folder.log" 2>&1 || {
    echo "$1 broke: see $folder.log and the input in $folder"
    broke=1
  }
  rm -rf "$folder/kept"
  mkdir "$folder/kept"
  # Without random addresses as in run_fuzz.sh.
  CONAV_FUZZ_READER=$1 setarch "$(uname -m)" -R "$2" -set_cover_merge=1 "$folder/kept" "$folder/corpus" >>"$folder.log" 2>&1 || {
    echo "$1: its corpus cannot be made smaller, see $folder.log"
    return 1
  }
  tar -czf "$here/corpus/$1.tar.gz" --sort=name --owner=0 --group=0 --mtime=@0 -C "$folder/kept" .
  sed -n "s/^stat::number_of_executed_units: */$1 /p" "$folder.log"
  return $broke
}

if [[ $1 == --one ]]; then
  build=$2 runs=$3
  fuzz "$4" "$5"
  exit
fi
build=$(cd "$1" && pwd) runs=${2-10000000}
{
  for name in page_input http_upgrade foxglove_input cdr pupil_message; do echo "$name $build/bin/${name}_fuzz"; done
  for name in mcap weights decisions segments segments_json yaml tokens csv map; do echo "$name $build/bin/file_fuzz"; done
} | xargs -P "$(nproc)" -L 1 "${BASH_SOURCE[0]}" --one "$build" "$runs"
