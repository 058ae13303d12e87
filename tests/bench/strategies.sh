#!/bin/bash
# Compares the ways of drawing on test set 32, on the default Vulkan device: prints CPU and GPU milliseconds a frame. docs/BENCHMARKS.md
# holds a run on a GPU; a software device needs smaller pictures and time: tests/bench/strategies.sh 320x180. Needs python3.
set -euo pipefail
cd "$(dirname "$0")/../.."
size=${1:-1920x1080}
bin=${SCENEGEN_BIN:-build/release/bin}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for c in 1 0.1 0.001; do
  "$bin/scenegen" --test-set 32 --cells 32x32x32 --coherence $c -q -o "$work/scene.glb"
  for camera in street aerial; do
    for how in inline octree-record octree queries-all "queries-all --late-visibility"; do
      # shellcheck disable=SC2086  # a strategy and its options
      "$bin/sceneplay" frames "$work/scene.glb" -o "$work/frames" --times 200:240.64:0.32 --size "$size" --shadows off --format bmp \
        --camera-path tests/bench/set32_$camera.json --report "$work/report.json" -q --strategy $how
      python3 - "$work/report.json" "C $c  $camera  $how" <<'P'
import json, sys
frames = json.load(open(sys.argv[1]))["frames"][8:]
mean = lambda of: sum(of(f) for f in frames) / len(frames)
stage = lambda name: mean(lambda f: f["stagesMs"][name] or 0)
cpu = sum(stage(s) for s in ("seek", "update", "cull", "record", "submit"))
print(f"{sys.argv[2]:48s} cpu {cpu:8.3f}  gpu {stage('gpu'):8.3f}  drawn {mean(lambda f: f['drawn']):9.0f}  kept {mean(lambda f: f['secondaries']):7.0f}"
      f"  recorded {mean(lambda f: f['recorded']):6.1f}  queries {mean(lambda f: f['queries']):7.0f}  reveals {mean(lambda f: f['reveals']):6.2f}")
P
    done
  done
done
