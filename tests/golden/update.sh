#!/bin/bash
# Writes what tests compare with anew, after a change that was wanted: pictures (render/golden) and counters (tools/sceneplay_guard). Look at
# `git diff` before committing: each line of counters.json that changed is work that every frame now does more or less of.
#   tests/golden/update.sh [BUILD_FOLDER]
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${1:-build/release}
cmake --build "$build" --target test_render_golden test_tools_sceneplay_guard
SCENEGEN_UPDATE_GOLDEN=1 "$build/bin/test_render_golden"
SCENEGEN_UPDATE_GOLDEN=1 "$build/bin/test_tools_sceneplay_guard"
git --no-pager diff --stat -- tests/golden
