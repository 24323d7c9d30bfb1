#!/usr/bin/env bash
# build.sh [--from-archive] PACKAGE.deb [TAG]: the OCI image of conav, by podman. Its base is debian:bookworm of a registry
# (environment BASE: another image), or, with --from-archive, a root file system made by mmdebstrap from Debian's archive.
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
fail() { printf 'build.sh: %s\n' "$*" >&2 && exit 2; }

archive=""
if [[ ${1-} == --from-archive ]]; then
  archive=yes
  shift
fi
[[ ${1-} == *.deb && -r $1 ]] || fail "expected the package that cpack makes: build.sh [--from-archive] build/release/conav_*.deb [TAG]"
tag=${2:-conav:$(dpkg-deb -f "$1" Version)}
for program in podman ${archive:+mmdebstrap}; do command -v "$program" >/dev/null || fail "needs $program: apt-get install $program"; done

context=$(mktemp -d)
trap 'rm -rf "$context"' EXIT
base=${BASE:-docker.io/library/debian:bookworm}
if [[ -n $archive ]]; then
  base=localhost/debian:bookworm
  mmdebstrap --variant=minbase bookworm - "${MIRROR:-http://deb.debian.org/debian}" | podman import --quiet - "$base"
fi
cp "$1" "$context/conav.deb"
podman build --file "$here/Containerfile" --build-arg "BASE=$base" --tag "$tag" "$context"
