#!/bin/bash
# Same arguments, same bytes: 1, 2 and 8 threads; optimized, hardly optimized and sanitized; g++ and clang.
set -euo pipefail
cd "$(dirname "$0")/.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
log=$out/log
for preset in release asan-ubsan clang; do
  cmake --preset $preset >"$log" 2>&1 || { cat "$log"; exit 1; }
  cmake --build --preset $preset --target scenegen >"$log" 2>&1 || { cat "$log"; exit 1; }
done
failed=0
check() {  # check ARGUMENTS...: one hash over all builds and thread counts
  local hashes
  hashes=$(for preset in release asan-ubsan clang; do
    for threads in 1 2 8; do
      "build/$preset/bin/scenegen" "$@" --threads $threads --quiet -o "$out/a.glb" 2>"$log" 2>&1 || { cat "$log"; exit 1; }
      sha256sum <"$out/a.glb"
    done
  done | sort -u)
  if [ "$(wc -l <<<"$hashes")" -ne 1 ]; then
    echo "DIFFERENT bytes for: scenegen $*"
    failed=1
  else
    echo "${hashes:0:16}  scenegen $*"
  fi
}
check --grid 4x4 --curve hilbert --coherence 0.95
check --grid 2x3 --curve morton --coherence 0.5 --layout nodes --visibility both --seed 7 --extras 5
check --grid 3x2 --curve row-prime --order=-z+y+x --layout groups --visibility pointer --cells 7x9x11
check --test-set 32 --curve hilbert --coherence 0.3
check --test-set 41
check --grid 2x2 --machines 5 --profile construct --highlight construct=#ff8000
check --grid 3x1 --machines 4 --profile drop --coherence 0.9
check --profile move --move-offset 0.1,-3,7 --color pointer --layout nodes
exit $failed
