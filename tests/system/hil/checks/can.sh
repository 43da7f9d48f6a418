#!/usr/bin/env bash
# can.sh classical|fd: what cansend sends, candump receives, bit for bit.
. "$(dirname "$0")/bench.sh"
printf -v bytes '%02X' {1..64}
classical=("123#" "7FF#00" "001#DEADBEEF01020304" "00000000#R" "1FFFFFFF#A5A5" "123#R8")
fd=("123##0" "7FF##1${bytes::24}" "456##1$bytes" "1ABCDEF0##3${bytes::96}" "321##2${bytes::40}")
case $1 in
    classical) frames=("${classical[@]}") ;;
    fd) frames=("${fd[@]}") ;;
esac

log=$TMPDIR/can.$$
is_listening() { grep -q "^ *$HIL_CAN " /proc/net/can/rcvlist_all; }
timeout "$patience_s" candump -L -n "${#frames[@]}" "$HIL_CAN" >"$log" &
candump=$!
background+=("$candump")
await "candump" is_listening
for frame in "${frames[@]}"; do cansend "$HIL_CAN" "$frame"; done
wait "$candump" || fail "not all frames arrived: $(<"$log")"
# Kernels since 6.0 tell an FD frame by bit 2 of its flags too, which cansend leaves out.
mapfile -t received < <(awk '{ print $3 }' "$log" | sed 's/##4/##0/; s/##5/##1/; s/##6/##2/; s/##7/##3/')
expect "frames of $1 CAN" "${frames[*]}" "${received[*]}"
