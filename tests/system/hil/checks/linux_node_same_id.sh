#!/usr/bin/env bash
# Two boards with one node id: both say so and range no more; when one is gone, the other goes on.
. "$(dirname "$0")/bench.sh"
. "$(dirname "$0")/linux_nodes.sh"
listen
start_node first first.fd
await "the first node" has_said first "state ranging"
start_node second first.fd
await "the conflict on the first board" has_said first "state id_conflict"
await "the conflict on the second board" has_said second "state id_conflict"
await "the conflict on the bus" heard "1 heartbeat id_conflict"
await "stopped sensors" heard_times "1 health . stopped" 8
listen_anew
await "heartbeats" heard_times "1 heartbeat id_conflict" 10
expect "ranges in conflict" 0 "$(decoded | grep -c '^1 range' || true)"
forget first
stop_node second
await "the first node alone" has_said first "state ranging"
listen_anew
await "its readings" heard_times "1 range 0 " 3
stop_node first
