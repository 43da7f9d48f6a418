#!/usr/bin/env bash
# The board inside the machine: one CAN interface, GPIO lines, two I2C buses with two modelled sensors each.
#   board.sh up FOLDER BIN   make it, and write FOLDER/board.env, which every command gets
#   board.sh down FOLDER     take it away (where the machine is not thrown away)
# Runs as root, inside. Exit code 77: this kernel has not what it takes.
set -euo pipefail
verb=$1 folder=$2
can=hil0
config=/sys/kernel/config/gpio-sim/octoskin
# Not in FOLDER: a sensor must never wait for the host.
faults=/run/octoskin_hil
range0=/run/octoskin_hil.range0
# Lines 0-3 are XSHUT and 4-7 GPIO1 of the four sensors; 8 and 9 are free.
line_names=(xshut0 xshut1 xshut2 xshut3 gpio1_0 gpio1_1 gpio1_2 gpio1_3 free0 free1)

skip() { echo "skipped: $*"; exit 77; }

make_can() {
    ip link add dev $can type vcan 2>/dev/null || skip "no vcan in this kernel, or no right to make one"
    ip link set $can mtu 72 txqueuelen 1000  # 72: CAN FD frames too
    ip link set up $can
}

make_lines() {
    mkdir $config 2>/dev/null || skip "no gpio-sim in this kernel, or no right to use it"
    mkdir $config/bank0
    echo 16 >$config/bank0/num_lines
    echo octoskin >$config/bank0/label
    for i in "${!line_names[@]}"; do
        mkdir $config/bank0/line"$i"
        echo "${line_names[i]}" >$config/bank0/line"$i"/name
    done
    echo 1 >$config/live
    chip=$(<$config/bank0/chip_name)
    lines=/sys/devices/platform/$(<$config/dev_name)/$chip
}

# serve BUS FIRST_SENSOR FUNCTION FUNCTION
serve() {
    local device=i2c-$1 a=$2 b=$(($2 + 1))
    [ ! -e "/dev/$device" ] || { echo "board: /dev/$device is there already"; exit 1; }
    rm -f "$faults.$device"
    mkfifo "$faults.$device"
    setsid "$bin/i2c_device" --device "$device" --record "$folder/ranged.$device" --faults "$faults.$device" \
        --sensor "sensor$a" "$lines/sim_gpio$a/value" "$lines/sim_gpio$((a + 4))/pull" "$3" \
        --sensor "sensor$b" "$lines/sim_gpio$b/value" "$lines/sim_gpio$((b + 4))/pull" "$4" \
        </dev/null >"$folder/$device.log" 2>&1 &
    echo $! >"$folder/$device.pid"
}

# await_device BUS: until it is there, or its server is not
await_device() {
    local end=$((SECONDS + 60))
    until [ -e "/dev/i2c-$1" ] || [ $SECONDS -ge $end ] || ! kill -0 "$(<"$folder/i2c-$1.pid")" 2>/dev/null; do sleep 0.1; done
    [ ! -e "/dev/i2c-$1" ] || return 0
    echo "board: /dev/i2c-$1 did not come"
    cat "$folder/i2c-$1.log"
    exit 1
}

up() {
    [ -e /dev/cuse ] || skip "no CUSE in this kernel (modprobe cuse)"
    [ -x "$bin/i2c_device" ] || skip "i2c_device is not built (libfuse3-dev)"
    make_can
    make_lines
    echo constant:250 >$range0
    serve 7 0 "file:$range0" constant:500
    serve 8 2 triangle:200:1000:4000 none
    cat >"$folder/board.env" <<TEXT
export HIL_FOLDER='$folder' HIL_BIN='$bin' HIL_CAN=$can HIL_CHIP=$chip HIL_LINES=$lines HIL_FAULTS=$faults HIL_RANGE0=$range0
TEXT
    await_device 7
    await_device 8
}

down() {
    local pid
    for pid in "$folder"/*.pid; do
        [ ! -e "$pid" ] || kill "$(<"$pid")" 2>/dev/null || true
    done
    if [ -e $config ]; then
        echo 0 >$config/live
        rmdir $config/bank0/line* $config/bank0 $config
    fi
    rm -f $faults.*
    ip link del $can 2>/dev/null || true
}

case $verb in
    up) bin=$3; up ;;
    down) down ;;
esac
