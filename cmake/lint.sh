#!/bin/sh
# clang-tidy over every source of the rooms and tools, two at a time. Needs a configured release build
# (build/release/compile_commands.json). `cmake/lint.sh FILE...` checks only these; `cmake/lint.sh --recent` those of which
# the file itself or a header of the same name changed in the last 50 commits (all of them in a shallow clone): a whole
# run takes 10 minutes on 2 cores.
set -eu
cd "$(dirname "$0")/.."
[ -f build/release/compile_commands.json ] || cmake --preset release >/dev/null
every() { git ls-files 'scene/*.cpp' 'timeline/*.cpp' 'gen/*.cpp' 'render/*.cpp' 'tools/*.cpp'; }
recent() {
  changed=$(git log --max-count=50 --name-only --format= | sort -u)
  every | while read -r file; do
    if printf '%s\n' "$changed" | grep -qxF -e "$file" -e "${file%.cpp}.h"; then echo "$file"; fi
  done
}
case ${1:-} in
  '') files=$(every) ;;
  --recent) files=$(recent) ;;
  *) files=$(printf '%s\n' "$@") ;;
esac
[ -n "$files" ] || exit 0
printf '%s\n' "$files" | tr '\n' '\0' |
  xargs -0 -n 1 -P 2 clang-tidy-14 --quiet -p build/release --extra-arg=-Wno-unknown-warning-option
