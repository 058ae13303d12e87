#!/bin/sh
# clang-format over every C++ and GLSL-free source of ours: `cmake/format.sh` mends, `cmake/format.sh --check` complains.
set -eu
cd "$(dirname "$0")/.."
case ${1:-} in --check) how='--dry-run -Werror' ;; '') how=-i ;; *) echo "usage: cmake/format.sh [--check]" >&2; exit 2 ;; esac
# shellcheck disable=SC2086
git ls-files -z '*.cpp' '*.h' | xargs -0 clang-format-14 $how
