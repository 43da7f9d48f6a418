#!/usr/bin/env bash
# A sensor that is gone, browns out, or holds its bus: told by name, its neighbours go on, and it comes back by itself.
. "$(dirname "$0")/bench.sh"
. "$(dirname "$0")/linux_nodes.sh"
fault() { echo "$*" >"$HIL_FAULTS.i2c-7"; }
took() { echo "$1 after $((SECONDS - since)) s"; }
listen
start_node first first.fd
await "the node" has_said first "state ranging"
await "a reading of each sensor" have_ranged 1 1

since=$SECONDS
fault sensor0 absent
await "the news that sensor 0 is lost" heard "1 health 0 lost no_answer"
listen_anew
await "readings of its neighbour on the bus" heard_times "1 range 1 " 5
await "readings of the other bus" heard_times "1 range 2 " 5
expect "readings of a sensor that is not there" 0 "$(decoded | grep -c '^1 range 0 ' || true)"
since=$SECONDS
fault sensor0 none
await "readings of sensor 0 again" heard_times "1 range 0 " 3
took "sensor 0 back"

# It is at its power-on address then: its own does not answer, until it is brought up anew.
listen_anew
since=$SECONDS
fault sensor1 brown_out
await "the news of sensor 1" heard "1 health 1 lost no_answer"
await "sensor 1 ranging again" heard "1 health 1 ranging"
await "readings of sensor 1 again" heard_times "1 range 1 " 3
took "sensor 1 back"

# SDA low in the next transfer, let go by a clock on it: the kernel's driver frees the bus, the node goes on.
listen_anew
since=$SECONDS
fault bus sda_stuck_low 1 100
await "sensor 0 after a held bus" heard_times "1 range 0 " 5
await "sensor 1 after a held bus" heard_times "1 range 1 " 5
await "all sensors as they should be" heard "1 heartbeat ranging 0"
took "the bus back"
stop_node first
