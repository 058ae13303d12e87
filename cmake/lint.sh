#!/bin/sh
# clang-tidy over every source of the rooms and tools, two at a time. Needs a configured release build
# (build/release/compile_commands.json). `cmake/lint.sh FILE...` checks only these.
set -eu
cd "$(dirname "$0")/.."
[ -f build/release/compile_commands.json ] || cmake --preset release >/dev/null
if [ $# -gt 0 ]; then printf '%s\0' "$@"; else git ls-files -z 'scene/*.cpp' 'timeline/*.cpp' 'gen/*.cpp' 'render/*.cpp' 'tools/*.cpp'; fi |
  xargs -0 -n 1 -P 2 clang-tidy-14 --quiet -p build/release --extra-arg=-Wno-unknown-warning-option
