#!/usr/bin/env bash
# What a program sees of a faulty part or bus: the kernel's own error numbers, and an end of it.
. "$(dirname "$0")/bench.sh"
fault() { echo "$*" >"$HIL_FAULTS.i2c-7"; }
identify() { transfer 7 w2@"${1:-0x29}" 0x01 0x0f r2; }
right="0xea 0xcc"
drive 0=1
await "the sensor" is_there 7 0x29

fault bus nack_address 2 0
refused "No such device or address" identify
refused "No such device or address" identify
expect "after two refusals" "$right" "$(identify)"
fault bus nack_byte 1 1
refused "Input/output error" identify
fault bus lose_arbitration 1 0
refused "Resource temporarily unavailable" identify
fault bus stretch 1 0
refused "Connection timed out" identify
fault bus sda_stuck_low 1 100
refused "Device or resource busy" identify
await "the bus, freed by clocks" identify
fault bus flip_bit 1 15
expect "a flipped bit" "0xea 0xcd" "$(identify)"

fault sensor0 absent
refused "No such device or address" identify
fault sensor0 none
expect "back" "$right" "$(identify)"
transfer 7 w3@0x29 0x00 0x01 0x30
fault sensor0 brown_out
refused "No such device or address" identify 0x30
await "the sensor after its brown-out" identify
