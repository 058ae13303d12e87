#!/bin/bash
# Regret of choosing: test sets and two dynamic towns, and an animation made of phases (nearly empty, open, occluded, much changing), in every fixed
# way and adaptively. Prints mean frame times; a software device needs small pictures: tests/bench/adaptive.sh OUTPUT --size 160x90. What is
# behind OUTPUT goes to sceneplay bench.
set -euo pipefail
cd "$(dirname "$0")/../.."
out=${1:?usage: tests/bench/adaptive.sh OUTPUT [options of sceneplay bench]}
shift
bin=${SCENEGEN_BIN:-build/release/bin}
mkdir -p "$out"
scenes=()
make() {
  scenes+=("$out/$1.glb")
  [ -f "$out/$1.glb" ] || "$bin/scenegen" "${@:2}" -q -o "$out/$1.glb"
}
for set in ${SETS:-8 13 17 23 32 36}; do make "set$set" --test-set "$set"; done
make town_coherent --grid 8x8 --curve hilbert --coherence 0.95
make town_random --grid 8x8 --curve hilbert --coherence 0
"$bin/sceneplay" bench "${scenes[@]}" -o "$out" --shadows off --warm-up 60 --frames "${FRAMES:-200}" \
  --strategy inline,octree,queries,adaptive --renderers kept "$@"
# Phases: one town without coherence, so a second of its timeline changes much and a thousandth little; what stands decides the rest.
phases=0:0.06:0.002,50%:50.2%:0.002%,99%:99.2%:0.002%,30%:90%:0.6%,99.9%:100%:0.001%
"$bin/sceneplay" bench "$out/town_random.glb" -o "$out/phases" --shadows off --warm-up 60 --times "$phases" --strategy inline,octree,queries,adaptive --renderers kept "$@"
