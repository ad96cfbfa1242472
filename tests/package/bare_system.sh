#!/usr/bin/env bash
# Checks an installation in a system that has nothing else. Runs as root; tools/try-packages starts it in a new chroot.
#   bare_system.sh TARBALL PACKAGES      TARBALL: its unpacked folder. PACKAGES: a folder of .deb files
set -euo pipefail
tarball=$1 packages=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

no_compiler() {
  for tool in cc c++ gcc g++ clang cmake make ninja; do
    if command -v "$tool" > /dev/null; then echo "error: this system has a compiler: $tool" >&2; exit 1; fi
  done
}

# Measures the clip with each SIMD target. The bytes of the samples must be those of the first run of all.
measure_with() {
  local name=$1 program=$2 simd
  for simd in "" avx2 sse4 scalar; do
    env -i ${simd:+MOIREGAUGE_SIMD=$simd} "$program" measure "$work/clip/video.mkv" --site "$work/clip/site.toml" --quiet -o "$work/$name-$simd"
    cmp "$work/$name-$simd/displacement.csv" "$work/tarball-/displacement.csv"
  done
  echo "$name: $(grep -c ',ok' "$work/$name-/displacement.csv") samples ok, the same bytes with every SIMD target"
}

no_compiler
env -i "$tarball/bin/moiregauge" --self-test
env -i "$tarball/bin/moiregauge" simulate small-1xyz --frames 6 --markers-only --codec ffv1 --quiet -o "$work/clip"
measure_with tarball "$tarball/bin/moiregauge"

apt-get update -qq
apt-get install -y -qq --no-install-recommends "$packages"/*.deb > "$work/apt.log" 2>&1 || { cat "$work/apt.log" >&2; exit 1; }
no_compiler
moiregauge --self-test
measure_with package /usr/bin/moiregauge
moiregauge solve "$work/package-" --quiet -o "$work/again"
test -s "$work/again/report.html"
python3 - "$work/clip/video.mkv" "$work/clip/site.toml" << 'PYTHON'
import sys
import time
begin = time.perf_counter()
import moiregauge
seconds = time.perf_counter() - begin
run = moiregauge.measure(sys.argv[1], site=sys.argv[2])
print(f"python: imported in {seconds:.2f} s, dy of mid, mm:", run["mid"].dy)
PYTHON
echo "passed: $(. /etc/os-release; echo "$PRETTY_NAME")"
