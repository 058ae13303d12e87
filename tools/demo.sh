#!/bin/sh
# The first command of the README: install what is missing, build, generate a town, and record it going up.
# Needs neither a GPU nor a display: Vulkan runs on the processor (lavapipe) where there is no GPU.
set -eu
cd "$(dirname "$0")/.."
tools/setup.sh build

echo "Building (some minutes the first time) ..." >&2
mkdir -p build/demo
if ! { cmake --preset release && cmake --build --preset release --target scenegen sceneplay; } >build/demo/build.log 2>&1; then
  tail -n 40 build/demo/build.log >&2
  echo "error: the build failed; the whole log is build/demo/build.log" >&2
  exit 1
fi

build/release/bin/scenegen --grid 4x4 --curve hilbert --coherence 0.95 -o build/demo/town.glb
build/release/bin/sceneplay frames build/demo/town.glb -o build/demo/frames --times 20%,40%,60%,80%,100% --camera auto --size 1280x720
echo "The pictures are build/demo/frames/*.png; the scene is build/demo/town.glb."
