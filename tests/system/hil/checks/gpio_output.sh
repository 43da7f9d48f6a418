#!/usr/bin/env bash
# gpioset's levels reach the other end of the line, and end when it lets go.
. "$(dirname "$0")/bench.sh"
expect "line 8, before" 0 "$(level 8)"
drive 8=1 9=0
expect "line 8, driven high" 1 "$(level 8)"
expect "line 9, driven low" 0 "$(level 9)"
refused "busy" gpioset "$HIL_CHIP" 8=0
let_go
await "line 8 let go" is_level 8 0
drive 8=0 9=1
expect "line 8, driven low" 0 "$(level 8)"
expect "line 9, driven high" 1 "$(level 9)"
