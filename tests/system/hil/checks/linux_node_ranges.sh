#!/usr/bin/env bash
# linux_node_ranges.sh fd|classical: two Linux nodes come up; every reading on the bus is what a sensor truly ranged, when it
# did; XSHUT and data ready move; SIGTERM ends it all.
. "$(dirname "$0")/bench.sh"
. "$(dirname "$0")/linux_nodes.sh"
listen
start_node first "first.$1"
start_node second "second.$1"
await "the first node" has_said first "state ranging"
await "the second node" has_said second "state ranging"
for line in 0 1 2 3; do
    expect "XSHUT $line of the first board" 1 "$(level $line)"
    expect "XSHUT $line of the second board" 1 "$(<"$HIL_LINES2/sim_gpio$line/value")"
done
# Another program may use the bus meanwhile; the sensor is at its own address.
expect "identification beside the node" "0xea 0xcc" "$(transfer 7 w2@0x30 0x01 0x0f r2)"
refused "Device or resource busy" gpioset "$HIL_CHIP" 0=0

interrupts() { awk '/octoskin-node/ { for (i = 2; i <= NF && $i ~ /^[0-9]+$/; ++i) sum += $i } END { print sum + 0 }' /proc/interrupts; }
before=$(interrupts)
listen_anew
await "five readings of each sensor" have_ranged 5 2
after=$(interrupts)
[ "$after" -gt $((before + 5)) ] || fail "the data-ready lines' interrupts: $before, then $after"

stop_node first
stop_node second
for line in 0 1 2 3; do
    expect "XSHUT $line of the first board, at the end" 0 "$(level $line)"
    expect "XSHUT $line of the second board, at the end" 0 "$(<"$HIL_LINES2/sim_gpio$line/value")"
done
drive 0=1  # the line is free
let_go
stop_listening
expect "frames that the host would reject" 0 "$(decoded | grep -c rejected || true)"
sleep 0.1  # the record is written every 10 ms
decoded | python3 "$(dirname "$0")/readings_are_true.py" "$HIL_FOLDER"
