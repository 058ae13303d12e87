#!/bin/bash
# Compares the ways of drawing on test set 32, on the default Vulkan device. docs/BENCHMARKS.md holds a run on a GPU; a software device needs
# smaller pictures and fewer runs: tests/bench/strategies.sh OUTPUT --size 320x180 --repeat 2. What is behind OUTPUT goes to sceneplay bench.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:?usage: tests/bench/strategies.sh OUTPUT [options of sceneplay bench]}
shift
bin=${SCENEGEN_BIN:-build/release/bin}
mkdir -p "$out"
scenes=()
for c in 1 0.1 0.001; do
  scenes+=("$out/set32_c$c.glb")
  [ -f "$out/set32_c$c.glb" ] || "$bin/scenegen" --test-set 32 --cells 32x32x32 --coherence $c -q -o "$out/set32_c$c.glb"
done
"$bin/sceneplay" bench "${scenes[@]}" -o "$out" --camera-path tests/bench/set32_street.json --camera-path tests/bench/set32_aerial.json \
  --times 200:240.64:0.32 --size 1920x1080 --shadows off --strategy inline,octree-record,octree,queries-all,queries-all:late "$@"
