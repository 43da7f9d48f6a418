#!/usr/bin/env bash
# What moves at the other end of a line, gpioget reads and gpiomon tells, each edge once, in order, with rising times.
. "$(dirname "$0")/bench.sh"
pull 9 up
expect "gpioget, pulled up" 1 "$(gpioget "$HIL_CHIP" 9)"
pull 9 down
expect "gpioget, pulled down" 0 "$(gpioget "$HIL_CHIP" 9)"

log=$TMPDIR/edges.$$
is_monitored() { gpioinfo "$HIL_CHIP" | grep -q 'line *9:.*"gpiomon"'; }
timeout "$patience_s" stdbuf -oL gpiomon --num-events=6 --format='%e %s %n' "$HIL_CHIP" 9 >"$log" &
gpiomon=$!
background+=("$gpiomon")
await "gpiomon" is_monitored
# One at a time: the simulator tells of an edge when it comes to it, by the level of then.
has_edges() { mapfile -t told <"$log" && [ ${#told[@]} -ge "$1" ]; }
for i in 1 3 5; do
    pull 9 up
    await "edge $i" has_edges "$i"
    pull 9 down
    await "edge $((i + 1))" has_edges $((i + 1))
done
wait "$gpiomon" || fail "not all edges were told: $(<"$log")"
expect "edges" "1 0 1 0 1 0" "$(awk '{ print $1 }' "$log" | xargs)"
times=$(awk '{ printf "%d%09d\n", $2, $3 }' "$log")
expect "times, rising" "$times" "$(sort -n -u <<<"$times")"
