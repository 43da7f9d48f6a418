#!/usr/bin/env bash
# The CAN link goes down, up, away and comes back; the adapter tells of errors: the node says so, waits, and is back by itself.
. "$(dirname "$0")/bench.sh"
. "$(dirname "$0")/linux_nodes.sh"
fd() { ip link set "$HIL_CAN" mtu 72 txqueuelen 1000; }
up() { fd; ip link set up "$HIL_CAN"; }
trap 'ip link add dev "$HIL_CAN" type vcan 2>/dev/null || true; up; kill "${background[@]}" 2>/dev/null || true' EXIT
is_back() {
    listen
    await "heartbeats after $1" heard_times "1 heartbeat ranging" 2
    await "readings after $1" heard_times "1 range 0 " 3
    stop_listening
}

ip link set down "$HIL_CAN"
start_node first first.fd
await "a node that starts with its link down" has_said first "$HIL_CAN: link down: Network is down.*waiting"
ip link set up "$HIL_CAN"
await "its start" has_said first "CAN: the interface is up"
await "its sensors" has_said first "state ranging"
is_back "a start with the link down"

forget first
ip link set down "$HIL_CAN"
await "the news of the link" has_said first "link down"
ip link set up "$HIL_CAN"
await "the news that it is up" has_said first "CAN: the interface is up"
is_back "the link's return"

forget first
ip link del "$HIL_CAN"
await "the news that it is gone" has_said first "$HIL_CAN: .*No such device.*waiting"
ip link add dev "$HIL_CAN" type vcan
ip link set "$HIL_CAN" mtu 16
ip link set up "$HIL_CAN"
await "an interface without CAN FD is refused" has_said first "asks for CAN FD"
ip link set down "$HIL_CAN"
up
await "the news that it is there" has_said first "CAN: the interface is up"
is_back "the interface's return"

# As an adapter tells: <linux/can/error.h>. 0x04 controller, byte 1: 0x20 transmit passive, 0x40 active again; 0x40 bus-off.
forget first
cansend "$HIL_CAN" 20000004#0020000000000000
await "the news of a passive controller" has_said first "CAN: error-passive"
await "the state" has_said first "state can_fault"
cansend "$HIL_CAN" 20000004#0040000000000000
await "the news of an active controller" has_said first "CAN: the controller takes part"
await "the state again" has_said first "state ranging"
forget first
cansend "$HIL_CAN" 20000040#0000000000000000
await "the news of bus-off" has_said first "state can_fault"
await "a second on the bus" has_said first "state ranging"
is_back "bus-off"
stop_node first
