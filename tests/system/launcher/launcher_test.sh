#!/usr/bin/env bash
# launcher_test.sh ROOT: what ./conav does with its command line. It runs a copy of the launcher in a tree without
# sources, where stand-ins for cmake, ctest and the programs write down how they were called.
set -euo pipefail
root=$(cd "$1" && pwd)
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

mkdir -p "$tree"/{tools,deploy}
cp "$root/conav" "$root/CMakeLists.txt" "$tree"
cp -r "$root/deploy/launcher" "$root/deploy/debian" "$tree/deploy"

tool() {  # tool NAME BODY
  printf '#!/usr/bin/env bash\n%s\n' "$2" >"$tree/tools/$1"
  chmod +x "$tree/tools/$1"
}
# shellcheck disable=SC2016  # the stand-ins expand these
{
  tool dpkg-query 'sed -n "s/^\([a-z][^ ]*\).*/\1 install ok installed/p" "$PACKAGES"'
  tool ctest 'echo "ctest $*" >>"$CALLS"; exit "${CTEST_CODE:-0}"'
  tool python 'echo "python $*" >>"$CALLS"'
  tool program 'echo "$(basename "$0") $*" >>"$CALLS"'
  # Configures an empty build; builds a program as a link to the stand-in.
  tool cmake 'echo "cmake $*" >>"$CALLS"
case $1 in
  --preset) mkdir -p "build/$2/bin" && touch "build/$2/build.ninja" ;;
  --build)
    bin=$2/bin
    shift 5
    for target in "$@"; do
      case $target in
        conav_programs) target=conav ;;
        conav_replay_programs) target=conav-replay ;;
        conav_python) continue ;;
      esac
      ln -sf ../../../tools/program "$bin/$target"
    done
    ;;
esac'
}
export PATH=$tree/tools:$PATH CONAV_PYTHON=$tree/tools/python CALLS=$tree/calls PACKAGES=$root/deploy/debian/packages.txt

fail() {
  printf '%s\n' "$@"
  failures=$((failures + 1))
}

# expect CODE PATTERN ARGUMENTS...: ./conav ARGUMENTS ends with CODE, and a line of what it prints, or of what it calls,
# matches PATTERN.
expect() {
  local code=$1 pattern=$2 got=0
  shift 2
  rm -rf "$tree/build" "$CALLS"
  touch "$CALLS"
  "$tree/conav" "$@" >"$tree/output" 2>&1 || got=$?
  [[ $got == "$code" ]] || fail "./conav $*: exit code $got, not $code" "$(<"$tree/output")"
  grep -qE -e "$pattern" "$tree/output" "$CALLS" -h || fail "./conav $*: no '$pattern' in" "$(cat "$tree/output" "$CALLS")"
}

expect_no_calls() {  # expect_no_calls ARGUMENTS...: nothing was built or started
  [[ ! -s $CALLS ]] || fail "./conav $* called" "$(<"$CALLS")"
}

# Help and version need no build: for every command of commands.txt, and for every verb of the general text.
mapfile -t commands < <(sed -n 's/^== //p' "$root/deploy/launcher/commands.txt" | sed 's/ = .*//')
mapfile -t verbs < <("$tree/conav" --help | sed -n 's/^  \([a-z][a-z-]*\)  .*/\1/p; s/^  \([a-z-]*\) [A-Z].*/\1/p')
((${#commands[@]} > 30 && ${#verbs[@]} > 10)) || fail "only ${#commands[@]} commands and ${#verbs[@]} verbs"
for command in "${commands[@]:1}" "${verbs[@]}"; do
  read -ra words <<<"$command"
  expect 0 "^Usage: .*conav[ -]${command// /[ -]}" "${words[@]}" --help
  expect_no_calls "$command" --help
done
expect 0 'conav train' train -h
expect 0 '^Usage: \./conav VERB' --help
expect 0 'conav study --live' study --participant P07 --help --live
expect 0 '^conav [0-9]+\.[0-9]+\.[0-9]+$' --version
expect_no_calls --version

# Wrong use builds nothing.
refused=0
refuse() {  # refuse PATTERN ARGUMENTS...
  expect 2 "$@"
  shift
  expect_no_calls "$@"
  refused=$((refused + 1))
}
refuse '^Usage'
refuse "verb 'fly'" fly
refuse 'up: .*sim' up
refuse 'up fly: .*sim' up fly
refuse 'bench fly: .*bus' bench fly
refuse 'fast' test --preset fast
refuse 'fast' test --preset=fast
refuse 'preset' build --preset
refuse '-L' test -L
refuse 'build' build --fast

# Which program runs with which arguments, and what is built for it.
expect 0 '^conav-maze --seed 3$' maze --seed 3
expect 0 '^conav demo --seed 3$' demo --seed 3
expect 0 '--target conav_programs$' demo
expect 0 '--target conav_replay_programs$' replay runs/a
expect 0 '^conav-sim --config a.yaml$' up sim --config a.yaml
expect 0 '^conav-bench-bus --json a$' bench bus --json a
expect 0 '^conav-dataset synthesize --seed 3$' dataset synthesize --seed 3
expect 0 '^conav-live-study --participant P07$' study --participant P07 --live
expect 0 '^conav-study-report runs/a --json -$' study report runs/a --json -
expect 0 '^conav-study --out report$' study --out report  # the value of an option
expect 0 '^conav-study --supervision --seeds 2$' study --seeds 2 --supervision
expect 0 '--target conav_programs conav_python$' build
expect 0 'asan .*--target conav_programs conav_python$' build --preset asan
expect 0 '^python -m conav bench --steps 3$' python bench --steps 3
expect 0 '^python -m conav leaderboard --check a.json$' leaderboard --check a.json
expect 0 '--target conav_python$' reproduce

# Tests: what is built, how ctest is called, what becomes of its exit code.
expect 0 'release .*--target all$' test
expect 0 '^conav: building took [0-9]+ s, testing [0-9]+ s$' test
expect 0 '^ctest --preset release --output-on-failure -R ig$' test -R ig
expect 0 'asan .*--target conav_tests_unit conav_tests_integration$' test --preset=asan -L unit -L integration
expect 0 '-L \^\(unit\|integration\)\$$' test -L unit -L integration
expect 0 '--target all$' test -L unit -L system
CTEST_CODE=8 expect 1 '^ctest' test

# A second build waits for the first one and says so.
mkdir -p "$tree/build"
exec 8>"$tree/build/release.lock"
flock 8
echo 'pid 7: ./conav test' >&8
"$tree/conav" build >"$tree/output" 2>&1 &
waiting=$!
for ((i = 0; i < 100; i++)); do
  ! grep -q 'waiting' "$tree/output" || break
  sleep 0.1
done
grep -q 'build/release (pid 7: ./conav test)' "$tree/output" || fail "a wait is not reported:" "$(<"$tree/output")"
kill -0 "$waiting" || fail "a build did not wait for the other one"
flock -u 8
wait "$waiting" || fail "a build that waited failed"

# Where the time of a build went: the last entry of each file that is still there, a step with two outputs once.
log=$tree/build/release/.ninja_log
folder=services/sim/CMakeFiles/sim.dir
mkdir -p "$tree/build/release/$folder"
touch "$tree/build/release/$folder/"{a,b}.o "$tree/build/release/"{x,y}.h
printf '%d\t%d\t0\t%s\t%s\n' 0 9000 "$folder/a.o" 1 0 2000 "$folder/a.o" 1 100 1600 "$folder/b.o" 2 0 9000 "$folder/gone.o" 3 \
  0 500 x.h 4 0 500 y.h 4 >"$log"
"$tree/conav" build --times >"$tree/output" 2>&1 || fail "build --times failed"
for line in 'build/release: 4 s of work in 3 steps' ' 3.5 s      2 steps  services/sim' " 2.0 s  $folder/a.o"; do
  grep -qF -- "$line" "$tree/output" || fail "build --times: no '$line' in" "$(<"$tree/output")"
done

echo "${#commands[@]} commands, $refused wrong uses, $failures failures"
((failures == 0))
