#!/bin/sh
# Installs what is missing on Debian 12, by name from Debian's own archive: `tools/setup.sh build` (build and run) or
# `tools/setup.sh test` (also tests, lint, fuzzing, validator). Silent when nothing is missing. Needs root or sudo only then.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
want=${1:-build}
case $want in build|test) ;; *) echo "usage: tools/setup.sh [build|test]" >&2; exit 2 ;; esac

missing=
part=
while read -r line; do
  case $line in
    ''|'#'*) continue ;;
    '['*']') part=$(echo "$line" | tr -d '[]'); continue ;;
  esac
  [ "$part" = build ] || [ "$want" = test ] || continue
  # A Node that is not Debian's brings its own npm, and the packages exclude each other: the command is what counts.
  case $line in
    nodejs) command -v node >/dev/null 2>&1 && continue ;;
    npm) command -v npm >/dev/null 2>&1 && continue ;;
  esac
  state=$(dpkg-query -W -f='${db:Status-Status}' "$line" 2>/dev/null || true)
  [ "$state" = installed ] || missing="$missing $line"
done < "$root/.ci/packages.txt"
[ -n "$missing" ] || exit 0

as_root=
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null 2>&1 || { echo "error: these packages are missing, and there is no sudo to install them:$missing" >&2; exit 3; }
  as_root=sudo
fi
echo "Installing from Debian:$missing" >&2
$as_root apt-get update -qq
# shellcheck disable=SC2086  # the list is meant to be split
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
