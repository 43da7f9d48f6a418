#!/usr/bin/env bash
# native.sh "CHECK [ARGUMENT]..."...: boot finds that this kernel has what boards take, and makes them on it, without another virtual
# machine. The checks pass there, nobody outside sees its interface, and at the end nothing of it is left.
. "$(dirname "$0")/bench.sh"
[ "$HIL_KIND" = virtual ] || { echo "skipped: this machine is one"; exit 77; }
checks=$(dirname "$0")
machine=$checks/../machine.py
folder=$HIL_FOLDER/native

on_machine() { "$machine" "$1" "${@:2}" || fail "machine.py $1: exit code $?"; }
boot() { "$machine" boot --bin "$HIL_BIN" "$folder"; }
interfaces() { ip -o link; }
devices() { ls -d /dev/i2c-* /dev/gpiochip* 2>/dev/null || true; }
lines() { ls /sys/kernel/config/gpio-sim; }
processes() { pgrep -f "$folder" || true; }
seen() { interfaces; devices; lines; processes; }

before=$(seen)
network=$(interfaces)
said=$(boot) || fail "$said"
echo "$said"
[[ $said == "native machine: this kernel has what it takes"* ]] || fail "it was not made on this kernel"
expect "interfaces that others see" "$network" "$(interfaces)"
for check in "$@"; do
    read -ra words <<<"$check"
    echo "-- $check"
    on_machine run --seconds 120 "$folder" "$checks/${words[0]}" "${words[@]:1}"
done
on_machine run "$folder" bash -c "exec -a '$folder/left_running' sleep 300 &"
on_machine stop "$folder"
expect "what is left of it" "$before" "$(seen)"
