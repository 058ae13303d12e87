#!/bin/bash
# Regret of choosing: test sets and two dynamic towns, and an animation made of phases (empty, open, much changing, occluded), in every fixed way
# and adaptively. Prints mean frame times. A software device needs small pictures, a small town, and fewer frames:
# GRID=4x4 FRAMES=40 SETS="8 17 23" PHASES=0:0.05:0.005,3:3.1:0.02,5:34:1,37:38.9:0.2,39.6:41.6:0.1 tests/bench/adaptive.sh OUTPUT --size 160x90. What is behind
# OUTPUT goes to sceneplay bench.
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
  --strategy inline,octree,queries,hi-z,adaptive --renderers kept "$@"
# Phases, a window of the timeline each, of 200 frames (the fourth of 19): nothing yet; one brick in fourteen, anywhere, from outside: open, next to nothing hides another (25 000
# draws); very much changing while the camera looks away (5500 objects a frame, to and fro, twice); all of it from outside, little changing; the same from a street, where houses hide the most. No one way is best in all of them.
make phases --grid "${GRID:-12x12}" --windows off --curve hilbert --coherence 0
"$bin/sceneplay" bench "$out/phases.glb" -o "$out/phases" --camera-path tests/bench/town_phases.json --shadows off --warm-up 60 \
  --times "${PHASES:-0:0.02:0.0001,3:3.1:0.0005,5:34.4:0.6,33.8:5:0.6,5.6:34.4:0.6,33.8:5:0.6,37:37.9:0.05,39.6:41.6:0.01}" --strategy inline,octree,queries,hi-z,adaptive --renderers kept "$@"
