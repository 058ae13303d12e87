#!/bin/bash
# Builds and runs every benchmark of the release preset, with the machine named first. docs/BENCHMARKS.md holds a run.
set -euo pipefail
cd "$(dirname "$0")/../.."
cmake --preset release >/dev/null
cmake --build --preset release >/dev/null
echo "machine: $(grep -m1 'model name' /proc/cpuinfo | cut -d: -f2 | xargs), $(nproc) cores, $(free -g | awk '/Mem/{print $2}') GiB"
echo "system:  $(. /etc/os-release && echo "$PRETTY_NAME"), $(g++ --version | head -1), scenegen $(build/release/bin/scenegen --version)"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for bench in build/release/bin/bench_*; do
  name=$(basename "$bench")
  printf '\n== %s\n' "$name"
  case $name in
    bench_accuracy | bench_bound | bench_device_choice) echo "needs a calibration or a scene: see the head of its source" ;;
    bench_programs) "$bench" build/release/bin "$work" --ten-million ;;
    *) (cd "$work" && "$OLDPWD/$bench") ;;
  esac
done
