#!/usr/bin/env bash
# units_test.sh ROOT BIN: systemd accepts the units of every service, and calls none of them exposed.
set -euo pipefail
root=$1 bin=$2
command -v systemd-analyze > /dev/null || { echo "skipped: no systemd-analyze"; exit 77; }
units=$(mktemp -d)
trap 'rm -rf "$units"' EXIT
cp -r "$root"/deploy/systemd/. "$units"
# The programs lie elsewhere here.
sed -i "s|/usr/lib/conav/bin/|$bin/|" "$units/conav@.service"
for service in sim nhpm operator planner recorder driver simulated-operator; do
  cp "$units/conav@.service" "$units/conav@$service.service"
  # It calls a key that it does not know a warning.
  said=$(SYSTEMD_UNIT_PATH=$units: systemd-analyze verify --man=no "$units/conav@$service.service" 2>&1) ||
    said+=" (refused)"
  [[ -z $said ]] || { echo "$said"; exit 1; }
  SYSTEMD_UNIT_PATH=$units: systemd-analyze security --offline=true --threshold=30 --no-pager \
    "$units/conav@$service.service" | tail -1
done
