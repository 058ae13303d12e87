#!/bin/sh
# Puts the programs' present --help into docs/CLI.md: tools/update_cli_doc.sh build/debug/bin
# Every block that begins with "```text" and "$ PROGRAM ... --help" is replaced by what that command prints.
set -eu
bin=$1
doc=$(dirname "$0")/../docs/CLI.md
out=$(mktemp)
trap 'rm -f "$out"' EXIT
skipping=no
while IFS= read -r line; do
  case $line in
    '```') skipping=no ;;
    '$ scenegen'*--help | '$ sceneplay'*--help)
      printf '%s\n' "$line" >>"$out"
      command=${line#'$ '}
      # shellcheck disable=SC2086 # words on purpose
      NO_COLOR=1 "$bin"/$command >>"$out"
      skipping=yes
      continue ;;
  esac
  [ $skipping = yes ] || printf '%s\n' "$line" >>"$out"
done <"$doc"
cat "$out" >"$doc"
