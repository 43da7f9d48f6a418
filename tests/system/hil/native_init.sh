#!/usr/bin/env bash
# The first process of a machine that is this one's kernel with interfaces, mounts and processes of its own: all that is in it ends
# with this process.
#   native_init.sh FOLDER   until SIGTERM; then it undoes what board.sh did
#   native_init.sh probe    only to see whether that can be; nothing is left of it
set -euo pipefail
[ $$ = 1 ] || { echo "native_init.sh: only as the first process of namespaces of its own"; exit 2; }
read -r first _ </proc/self/stat  # as the others number it, until this has a /proc of its own
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t configfs configfs /sys/kernel/config 2>/dev/null || true  # board.sh says so if it needs it
mount -t tmpfs tmpfs /run
if [ "$1" = probe ]; then exec ip link add dev probe type vcan; fi

folder=$1
undo_board() { "$(dirname "$0")/board.sh" down "$folder"; }
undo_board  # what is left of a machine of this folder that was killed
trap : TERM
cd /
sleep infinity &
echo "$first" >"$folder/first"
: >"$folder/up"
wait $! || true
disown || true  # gone already, if the end was told to all of us

kill -KILL -1 || true  # of its own processes; who was given a line or a device keeps it until then
for _ in {1..100}; do
    left=(/proc/[0-9]*)
    [ ${#left[@]} -gt 1 ] || break
    sleep 0.05
done
undo_board
: >"$folder/undone"
