#!/bin/bash
# The second command of the README: install what is missing, build everything, run every check.
#   tests/run.sh          all that one change can break (25 to 30 minutes on 2 cores)
#   tests/run.sh quick    only the release build and its tests
#   tests/run.sh full     also lint of every file, tests labelled `long` (all viewers, Blender if there), 10 minutes of fuzzing
# Stages print their time; the first failure stops the run.
set -euo pipefail
cd "$(dirname "$0")/.."
what=${1:-all}
case $what in all|quick|full) ;; *) echo "usage: tests/run.sh [quick|full]" >&2; exit 2 ;; esac
logs=build/logs
mkdir -p "$logs"

stage() {  # stage NAME COMMAND...: one line a stage, the log only when it fails
  local name=$1 start=$SECONDS
  shift
  printf '== %s\n' "$name"
  if ! "$@" >"$logs/$name.log" 2>&1; then
    tail -n 80 "$logs/$name.log"
    printf '== %s FAILED after %d s (whole log: %s)\n' "$name" $((SECONDS - start)) "$logs/$name.log"
    exit 1
  fi
  grep -hE '^(100%|[0-9]+%) tests passed|^Done [0-9]+ runs|skipped' "$logs/$name.log" | tail -n 3 || true
  printf '== %s passed in %d s\n' "$name" $((SECONDS - start))
}

build() { cmake --preset "$1" && cmake --build --preset "$1" "${@:2}"; }
tests() { ctest --preset "$1" -j 2 "${@:2}"; }

stage setup tools/setup.sh test
stage format cmake/format.sh --check
stage build-release build release
stage test-release tests release
if [ "$what" != quick ]; then
  lint_what=--recent
  fuzz_s=60
  if [ "$what" = full ]; then
    stage test-long ctest --test-dir build/release -L long --output-on-failure
    lint_what=
    fuzz_s=600
  fi
  stage build-asan-ubsan build asan-ubsan --target scenegen sceneplay sanitized_tests
  stage test-asan-ubsan tests asan-ubsan -L sanitized
  stage lint cmake/lint.sh $lint_what
  stage determinism tests/determinism.sh
  stage fuzz tests/fuzz/run.sh $fuzz_s
fi
# The closing summary of the main run once more, last, for whoever reads only the end.
grep -hE 'tests passed|tests failed' "$logs/test-release.log"
echo "All checks passed."
