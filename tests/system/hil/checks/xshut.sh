#!/usr/bin/env bash
# XSHUT low: a sensor vanishes and forgets its address. High: it is back at 0x29. Its neighbour is not touched.
. "$(dirname "$0")/bench.sh"
refused "No such device or address" is_there 7 0x29
drive 0=1
await "the first sensor" is_there 7 0x29
transfer 7 w3@0x29 0x00 0x01 0x30
expect "at its own address" "0xea 0xcc" "$(is_there 7 0x30)"
refused "No such device or address" is_there 7 0x29

first=$driver
drive 1=1
await "the second sensor" is_there 7 0x29
transfer 7 w3@0x29 0x00 0x01 0x31
kill "$first"
wait "$first" || true
await "line 0 low" is_level 0 0
refused "No such device or address" is_there 7 0x30
refused "No such device or address" is_there 7 0x29
expect "its neighbour" "0xea 0xcc" "$(is_there 7 0x31)"
drive 0=1
await "the first sensor again" is_there 7 0x29
refused "No such device or address" is_there 7 0x30
expect "its neighbour, still" "0xea 0xcc" "$(is_there 7 0x31)"
