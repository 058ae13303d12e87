#!/bin/sh
# Fuzzes the glTF reader: tests/fuzz/run.sh [SECONDS]. Inputs that fail are left in build/fuzz/found; fix, then move them to tests/fuzz/found.
set -eu
cd "$(dirname "$0")/../.."
[ -f build/fuzz/build.ninja ] || cmake --preset fuzz
ninja -C build/fuzz fuzz_gltf fuzz_make_corpus
mkdir -p build/fuzz/work build/fuzz/found
build/fuzz/bin/fuzz_make_corpus build/fuzz/corpus
exec build/fuzz/bin/fuzz_gltf -max_total_time="${1:-60}" -timeout=10 -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 \
  -dict=tests/fuzz/gltf.dict -artifact_prefix=build/fuzz/found/ build/fuzz/work build/fuzz/corpus
