#!/usr/bin/env bash
# What does not fit is refused in a sentence, with the exit code that the manual says, and nothing is left behind.
. "$(dirname "$0")/bench.sh"
block=$HIL_BLOCKS/first.fd.block
# refuses CODE WHY ARGUMENT...
refuses() {
    local code=0 wanted=$1 why=$2 said
    shift 2
    said=$("$HIL_BIN/octoskin-node" --can "$HIL_CAN" --uid 0102030405060708090a0b0c "$@" 2>&1) || code=$?
    expect "exit code of '$*'" "$wanted" $code
    [[ $said == *"$why"* ]] || fail "'$*' said: $said"
}
buses=(--i2c /dev/i2c-7 /dev/i2c-8)
lines=(--xshut "$HIL_CHIP:0,1,2,3")
refuses 66 "cannot be read" --config "$TMPDIR/nothing.block" "${buses[@]}" "${lines[@]}"
refuses 78 "no configuration block" --config "$0" "${buses[@]}" "${lines[@]}"
refuses 78 "sensor 2 is on bus 1" --config "$block" --i2c /dev/i2c-7 "${lines[@]}"
refuses 78 "sensor 3 is on xshut_line 3" --config "$block" "${buses[@]}" --xshut "$HIL_CHIP:0,1,2"
refuses 69 "/dev/i2c-99: No such file or directory" --config "$block" --i2c /dev/i2c-7 /dev/i2c-99 "${lines[@]}"
refuses 69 "/dev/null: not an I2C adapter" --config "$block" --i2c /dev/i2c-7 /dev/null "${lines[@]}"
refuses 69 "GPIO chip gpiochip99" --config "$block" "${buses[@]}" --xshut gpiochip99:0,1,2,3
refuses 69 "the chip has no such line" --config "$block" "${buses[@]}" --xshut "$HIL_CHIP:0,1,2,99"
refuses 64 "CHIP:LINE" --config "$block" "${buses[@]}" --xshut 0,1,2,3
drive 2=1
refuses 69 "GPIO line $HIL_CHIP:2: Device or resource busy" --config "$block" "${buses[@]}" "${lines[@]}"
let_go
drive 0=1  # nobody has kept a line
