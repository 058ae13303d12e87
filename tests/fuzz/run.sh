#!/bin/sh
# Fuzzes the readers of glTF (two thirds of the time) and of plans: tests/fuzz/run.sh [SECONDS]. Inputs that fail are left in
# build/fuzz/found; fix, then move them to tests/fuzz/found (glTF) or tests/fuzz/plans.
set -eu
cd "$(dirname "$0")/../.."
[ -f build/fuzz/build.ninja ] || cmake --preset fuzz
ninja -C build/fuzz fuzz_gltf fuzz_make_corpus fuzz_plan
mkdir -p build/fuzz/work build/fuzz/work_plan build/fuzz/found
build/fuzz/bin/fuzz_make_corpus build/fuzz/corpus
seconds=${1:-60}
fuzz() { # TARGET SECONDS DICTIONARY FOLDER...
  target=$1 time=$2 words=$3
  shift 3
  build/fuzz/bin/"$target" -max_total_time="$time" -timeout=10 -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 \
    -dict=tests/fuzz/"$words" -artifact_prefix=build/fuzz/found/ "$@"
}
fuzz fuzz_gltf $((seconds * 2 / 3)) gltf.dict build/fuzz/work build/fuzz/corpus
fuzz fuzz_plan $((seconds - seconds * 2 / 3)) plan.dict build/fuzz/work_plan tests/fuzz/plans
