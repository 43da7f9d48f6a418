#!/usr/bin/env bash
# linux_node_ranges.sh fd|classical: two Linux nodes on CAN FD, the first alone on classical CAN, come up; every reading on the bus is
# what a sensor truly ranged, when it did; XSHUT and data ready move; SIGTERM ends it all.
. "$(dirname "$0")/bench.sh"
. "$(dirname "$0")/linux_nodes.sh"
case $1 in
    fd) boards=(first second) ;;
    classical) boards=(first) ;;  # other frames of the same readings
esac
declare -A lines_of=([first]=$HIL_LINES [second]=$HIL_LINES2)
# expect_xshut LEVEL WHEN
expect_xshut() {
    local board line
    for board in "${boards[@]}"; do
        for line in 0 1 2 3; do expect "XSHUT $line of the $board board, $2" "$1" "$(<"${lines_of[$board]}/sim_gpio$line/value")"; done
    done
}
listen
for board in "${boards[@]}"; do start_node "$board" "$board.$1"; done
for board in "${boards[@]}"; do await "the $board node" has_said "$board" "state ranging"; done
# A sensor that is found silent is in reset for a moment, as happens where the processor is wanted elsewhere.
for board in "${boards[@]}"; do
    for line in 0 1 2 3; do
        await "XSHUT $line of the $board board, while it ranges" grep -q 1 "${lines_of[$board]}/sim_gpio$line/value"
    done
done
# Another program may use the bus meanwhile; the sensor is at its own address.
expect "identification beside the node" "0xea 0xcc" "$(transfer 7 w2@0x30 0x01 0x0f r2)"
refused "Device or resource busy" gpioset "$HIL_CHIP" 0=0

interrupts() { awk '/octoskin-node/ { for (i = 2; i <= NF && $i ~ /^[0-9]+$/; ++i) sum += $i } END { print sum + 0 }' /proc/interrupts; }
before=$(interrupts)
# What was heard before stays: a reading's bound may have been told before the reading.
heard_before=$(wc -l <"$log")
await "five readings of each sensor" have_ranged 5 ${#boards[@]} "$heard_before"
after=$(interrupts)
[ "$1" = classical ] || [ "$after" -gt $((before + 5)) ] || fail "the data-ready lines' interrupts: $before, then $after"

for board in "${boards[@]}"; do stop_node "$board"; done
expect_xshut 0 "at the end"
drive 0=1  # the line is free
let_go
stop_listening
expect "frames that the host would reject" 0 "$(decoded | grep -c rejected || true)"
cp "$log" "$HIL_FOLDER/frames.log"
decoded | tee "$HIL_FOLDER/frames.decoded" | python3 "$(dirname "$0")/readings_are_true.py" "$HIL_FOLDER" ${#boards[@]}
