#!/bin/bash
# The gain of choosing (D 4.3): test set 32 with 32x32x32 cells, a street-level and an aerial camera, one and two frames in flight, over coherences
# C. Three windows of the animation, one moment group of 1024 a frame: early, half built, nearly done. About 8 minutes on a large GPU, making the
# scenes included; fewer values of C take less: COHERENCE="1 0.001" tests/bench/adaptive_gpu.sh OUTPUT. What is behind OUTPUT goes to sceneplay bench.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:?usage: tests/bench/adaptive_gpu.sh OUTPUT [options of sceneplay bench]}
shift
bin=${SCENEGEN_BIN:-build/release/bin}
mkdir -p "$out"
scenes=()
# All values of the dissertation's figure.
for c in ${COHERENCE:-0.001 0.01 0.03 0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 0.95 0.999 1}; do
  scenes+=("$out/set32_c$c.glb")
  [ -f "$out/set32_c$c.glb" ] || "$bin/scenegen" --test-set 32 --cells 32x32x32 --coherence "$c" -q -o "$out/set32_c$c.glb"
done
"$bin/sceneplay" bench "${scenes[@]}" -o "$out" --camera-path tests/bench/set32_street.json --camera-path tests/bench/set32_aerial.json \
  --times 80:89.28:0.32,180:189.28:0.32,290:299.28:0.32 --size 1920x1080 --shadows off --frames-in-flight 1,2 --repeat 1 --warm-up 60 \
  --strategy inline,octree-record,octree,queries,hi-z,adaptive "$@"
