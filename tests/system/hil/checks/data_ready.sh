#!/usr/bin/env bash
# A sensor that is started by register writes becomes ready: its GPIO1 line moves, its result is what is there to be seen.
. "$(dirname "$0")/bench.sh"
wall() { echo "$1" >"$HIL_RANGE0"; }
# On bus 7 for the first sensor, on bus 8 for the third.
register16() { transfer "$1" w2@0x29 0x00 "$2" r2 | { read -r high low; echo $((high * 256 + low)); }; }
status() { echo $(($(transfer "$1" w2@0x29 0x00 0x89 r1) & 0x1f)); }
clear_interrupt() { transfer "$1" w3@0x29 0x00 0x86 0x01; }
# Pin: interrupt on a new sample, active high; a period of about 100 ms; firmware enabled; then the start of timed ranging.
configure() {
    transfer "$1" w4@0x29 0x00 0x30 0x01 0x02
    transfer "$1" w3@0x29 0x00 0x46 0x20
    transfer "$1" w6@0x29 0x00 0x6c 0x00 0x00 0x0f 0x89
    transfer "$1" w4@0x29 0x00 0x85 0x01 0x01
}
start() { transfer "$1" w3@0x29 0x00 0x87 0x40; }
# expect_near WHAT WANTED GOT: to a millimetre, of rounding
expect_near() { [ $(($3 - $2)) -ge -1 ] && [ $(($3 - $2)) -le 1 ] || fail "$1: wanted $2 mm, got $3 mm"; }

wall constant:250
drive 0=1 2=1
await "the first sensor" is_there 7 0x29
expect "GPIO1 of a sensor without configuration" 1 "$(gpioget "$HIL_CHIP" 4)"
configure 7
await "GPIO1 low" is_level 4 0
timeout "$patience_s" gpiomon --num-events=2 --silent "$HIL_CHIP" 4 &  # up by the range, down by the interrupt's clearing
gpiomon=$!
background+=("$gpiomon")
is_monitored() { gpioinfo "$HIL_CHIP" | grep -q 'line *4:.*"gpiomon"'; }
await "gpiomon" is_monitored
start 7
await "the first range" is_level 4 1
expect "status" 9 "$(status 7)"
expect_near "range" 250 "$(register16 7 0x96)"
clear_interrupt 7
wait "$gpiomon" || fail "gpiomon saw no edges"

# What is there may change at any time: the second range from now on is all new.
see() {
    wall "$1"
    for _ in 1 2 3; do
        clear_interrupt 7
        await "a range" is_level 4 1
    done
}
see constant:640
expect_near "range of another wall" 640 "$(register16 7 0x96)"
see none
expect "status with nothing in sight" 4 "$(status 7)"
wall constant:250

# The third sensor sees a wall that goes to and fro; what it ranged, and when, is on record.
configure 8
start 8
await "the third sensor's range" is_level 6 1
read -r _ _ stream _ _ _ _ _ _ _ _ _ _ high low _ < <(transfer 8 w2@0x29 0x00 0x89 r17)
range_mm=$((high * 256 + low))
# NAME INDEX MIDDLE_US READY_US STATUS STREAM RANGE_MM
is_recorded() { record=$(grep "^sensor2 .* $((stream)) $range_mm$" "$HIL_FOLDER/ranged.i2c-8" | tail -n 1) && [ -n "$record" ]; }
await "the record of $range_mm mm, stream $((stream))," is_recorded
read -r _ _ middle_us _ <<<"$record"
phase_us=$((middle_us % 4000000))
[ $phase_us -lt 2000000 ] || phase_us=$((4000000 - phase_us))
expect_near "a moving wall" $((200 + 800 * phase_us / 2000000)) $range_mm
