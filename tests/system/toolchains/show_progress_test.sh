#!/usr/bin/env bash
# show_progress as ./demo and ./check use it: it returns what the build does, keeps its output, and tells how far it is,
# even after seconds in which the build says nothing that can be counted. Usage: show_progress_test.sh SOURCE_DIR
set -euo pipefail
. "$1/toolchains/show_progress.sh"
log=$(mktemp)
trap 'rm -f "$log" "$log.out"' EXIT
fail() { echo "show_progress_test: $*" >&2; cat "$log.out" >&2; exit 1; }

build() {
    echo "-- Configuring"
    sleep 2.2
    for i in 1 2 3 4; do echo "[$i/4] Building $i"; sleep 0.6; done
    return "$1"
}
show_progress "$log" build 0 >"$log.out" || fail "a build that succeeds is said to fail"
grep -qE '^ +[0-9]+ %: [1-4]/4 steps' "$log.out" || fail "does not tell how far the build is"
[ "$(wc -l <"$log.out")" -le 10 ] || fail "tells more than every tenth"
[ "$(wc -l <"$log")" -eq 5 ] || fail "loses output of the build"
outcome=0
show_progress "$log" build 3 >"$log.out" || outcome=$?
[ "$outcome" -eq 3 ] || fail "returns $outcome for a build that fails with 3"
