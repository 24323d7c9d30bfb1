#!/usr/bin/env bash
# package_test.sh SOURCE BUILD: what `cmake --install` and the Debian package hold is enough to run conav without the source tree.
set -euo pipefail  # so no `grep -q` ends a pipe early
source=$1 build=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { printf '%s\n' "$*" && exit 1; }

cmake --install "$build" --prefix "$work/usr" >"$work/install.txt"
(cd "$build" && cpack -G DEB -B "$work" >"$work/cpack.txt" 2>&1) || fail "$(cat "$work/cpack.txt")"
package=$(echo "$work"/conav_*.deb)
dpkg-deb -f "$package" Depends | tee "$work/depends.txt"
grep -q libfastrtps "$work/depends.txt" || fail "a library of DDS is missing in Depends"
dpkg-deb -I "$package" conffiles | grep -x /etc/conav/sim.yaml >/dev/null || fail "configurations are no conffiles"
dpkg-deb -x "$package" "$work/package"
diff <(cd "$work/usr" && find lib/conav -type f | sort) <(cd "$work/package/usr" && find lib/conav -type f | sort) || fail "the package differs from cmake --install"
for name in $(dpkg-deb -I "$package" conffiles); do [[ -e $work/package$name ]] || fail "$name is not in the package"; done

[[ -e $work/package/usr/lib/systemd/system/conav@.service ]] || fail "no unit for systemd"

conav=$work/package/usr/bin/conav
[[ $("$conav" --version) == "conav $(dpkg-deb -f "$package" Version)" ]] || fail "--version"
"$conav" demo --help | grep 'Usage: conav demo' >/dev/null || fail "demo --help"
code=0
"$conav" build 2>"$work/refusal.txt" || code=$?
((code == 2)) || fail "build: exit code $code"
grep -q "source tree" "$work/refusal.txt" || fail "build does not say that it needs the source tree"

# Where mount namespaces can be made, nothing of the source tree is there.
run=(bash -c)
if unshare -m true 2>/dev/null; then run=(unshare -m bash -c "mount -t tmpfs none '$source' && eval \"\$0\""); fi
"${run[@]}" "cd '$work' && '$conav' demo --headless --seed 7 --dds mixed --domain ${CONAV_TEST_DOMAIN:-95} --json result.json" ||
  fail "the demo of the package failed"
grep -q '"all_goals_reached": *true' "$work/result.json" || fail "the robots of the package's demo did not reach their goals"
