#!/usr/bin/env bash
# The boards inside the machine: one CAN interface, two banks of GPIO lines, four I2C buses with two modelled sensors each.
#   board.sh up FOLDER BIN   make it, and write FOLDER/board.env, which every command gets
#   board.sh can FOLDER BIN  only the CAN interface
#   board.sh down FOLDER     take away what does not end with its processes, where the kernel goes on
# Runs as root, inside. Exit code 77: this kernel has not what it takes.
set -euo pipefail
verb=$1 folder=$2
can=hil0
# By the folder's name: of a kernel that is not the machine's own, others may have lines there.
config=/sys/kernel/config/gpio-sim/octoskin_$(cksum <<<"$folder" | cut -d ' ' -f 1)
# Not in FOLDER: a sensor must never wait for the host.
faults=/run/octoskin_hil
range0=/run/octoskin_hil.range0
# The first board: lines 0-3 are XSHUT and 4-7 GPIO1 of its four sensors; 8 and 9 are free.
first_lines=(xshut0 xshut1 xshut2 xshut3 gpio1_0 gpio1_1 gpio1_2 gpio1_3 free0 free1)
# The second: 0-3 are XSHUT, 4 and 5 the data-ready lines of its buses, each GPIO1 of two sensors wired together.
second_lines=(xshut4 xshut5 xshut6 xshut7 data_ready0 data_ready1)

skip() { echo "skipped: $*"; exit 77; }

make_can() {
    ip link add dev $can type vcan 2>/dev/null || skip "no vcan in this kernel, or no right to make one"
    ip link set $can mtu 72 txqueuelen 1000  # 72: CAN FD frames too
    ip link set up $can
}

# make_bank NUMBER NAME...
make_bank() {
    local bank=$config/bank$1 names=("${@:2}") i
    mkdir "$bank"
    echo 16 >"$bank/num_lines"
    echo "octoskin$1" >"$bank/label"
    for i in "${!names[@]}"; do
        mkdir "$bank/line$i"
        echo "${names[i]}" >"$bank/line$i/name"
    done
}

make_lines() {
    mkdir "$config" 2>/dev/null || skip "no gpio-sim in this kernel, or no right to use it"
    make_bank 0 "${first_lines[@]}"
    make_bank 1 "${second_lines[@]}"
    echo 1 >"$config/live"
    local device
    device=/sys/devices/platform/$(<"$config/dev_name")
    chip=$(<"$config/bank0/chip_name")
    lines=$device/$chip
    chip2=$(<"$config/bank1/chip_name")
    lines2=$device/$chip2
}

# wire BUS LINES FIRST_SENSOR {XSHUT_LINE GPIO1_LINE FUNCTION} for each of two sensors
wire() {
    local device=i2c-$1 lines=$2 a=$3 b=$(($3 + 1))
    [ ! -e "/dev/$device" ] || { echo "board: /dev/$device is there already"; exit 1; }
    rm -f "$faults.$device"
    mkfifo "$faults.$device"
    sensors+=(--sensor "$device" "sensor$a" "$lines/sim_gpio$4/value" "$lines/sim_gpio$5/pull" "$6"
        --sensor "$device" "sensor$b" "$lines/sim_gpio$7/value" "$lines/sim_gpio$8/pull" "$9")
}

# serve_sensors: what was wired
serve_sensors() {
    setsid "$bin/i2c_device" --record "$folder/ranged" --faults "$faults" "${sensors[@]}" \
        </dev/null >"$folder/i2c_device.log" 2>&1 &
    echo $! >"$folder/i2c_device.pid"
}

# await_device BUS: until it is there, or its server is not
await_device() {
    local end=$((SECONDS + 60))
    until [ -e "/dev/i2c-$1" ] || [ $SECONDS -ge $end ] || ! kill -0 "$(<"$folder/i2c_device.pid")" 2>/dev/null; do sleep 0.1; done
    [ ! -e "/dev/i2c-$1" ] || return 0
    echo "board: /dev/i2c-$1 did not come"
    cat "$folder/i2c_device.log"
    exit 1
}

write_environment() {
    cat >"$folder/board.env" <<TEXT
export HIL_FOLDER='$folder' HIL_BIN='$bin' HIL_BLOCKS='$bin/hil_blocks' HIL_RECORDING='$bin/hil_recording' HIL_CAN=$can HIL_CHIP=${chip:-} HIL_LINES=${lines:-} HIL_CHIP2=${chip2:-} HIL_LINES2=${lines2:-} HIL_FAULTS=$faults HIL_RANGE0=$range0
TEXT
}

up() {
    [ -e /dev/cuse ] || skip "no CUSE in this kernel (modprobe cuse)"
    [ -x "$bin/i2c_device" ] || skip "i2c_device is not built (libfuse3-dev)"
    make_can
    make_lines
    echo constant:250 >$range0
    local sensors=()
    wire 7 "$lines" 0 0 4 "file:$range0" 1 5 constant:500
    wire 8 "$lines" 2 2 6 triangle:200:1000:4000 3 7 none
    wire 9 "$lines2" 4 0 4 constant:300 1 4 triangle:300:900:3000
    wire 10 "$lines2" 6 2 5 constant:700 3 5 constant:900
    serve_sensors
    write_environment
    local bus
    for bus in 7 8 9 10; do await_device $bus; done
}

down() {
    [ -d "$config" ] || return 0
    echo 0 >"$config/live" 2>/dev/null || true  # refused, if they were not made to the end
    shopt -s nullglob
    rmdir "$config"/bank?/line* "$config"/bank? "$config"
}

case $verb in
    up) bin=$3; up ;;
    can) bin=$3; make_can; write_environment ;;
    down) down ;;
esac
