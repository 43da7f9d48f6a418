# shellcheck shell=bash
# What the checks of octoskin-node share; sourced by each after bench.sh. Two boards: board.sh says how they are wired.
patience_s=120  # each has hundreds of transfers to make, on an emulated processor
declare -A node_pid

# start_node BOARD BLOCK: board first or second, with the block BLOCK of $HIL_BLOCKS; what it says goes to $TMPDIR/BOARD.said.
start_node() {
    local devices
    case $1 in
        first) devices=(--i2c /dev/i2c-7 /dev/i2c-8 --xshut "$HIL_CHIP:0,1,2,3" --uid 0102030405060708090a0b0c) ;;
        second) devices=(--i2c /dev/i2c-9 /dev/i2c-10 --xshut "$HIL_CHIP2:0,1,2,3" --data-ready "$HIL_CHIP2:4,5"
                    --uid 1112131415161718191a1b1c) ;;
    esac
    # The emulated processor keeps a transfer waiting for up to a tenth of a second.
    "$HIL_BIN/octoskin-node" --config "$HIL_BLOCKS/$2.block" --can "$HIL_CAN" --i2c-lateness-ms 500 "${devices[@]}" \
        2>"$TMPDIR/$1.said" &
    node_pid[$1]=$!
    background+=("$!")
}
# say BOARD TEXT: whether it has said so
has_said() { grep -q -- "$2" "$TMPDIR/$1.said"; }
# Since `forget`.
forget() { : >"$TMPDIR/$1.said"; }
stop_node() {
    local code=0
    kill "${node_pid[$1]}"
    wait "${node_pid[$1]}" || code=$?
    expect "exit code of the $1 board's node" 0 $code
}

# listen [FILTER]: all frames, or those that pass, into $log, line by line; decoded by the host's decoder.
log=$TMPDIR/frames.$$
listen() {
    stdbuf -oL candump -L "$HIL_CAN${1:+,$1}" >>"$log" &
    listener=$!
    background+=("$!")
    await "candump" grep -q "^ *$HIL_CAN " /proc/net/can/rcvlist_all /proc/net/can/rcvlist_fil /proc/net/can/rcvlist_sff
}
stop_listening() {
    kill "$listener"
    wait "$listener" || true
}
listen_anew() { : >"$log"; }
decoded() { "$HIL_BIN/decode_log" "$log"; }
# heard_times PATTERN COUNT: so many decoded lines begin with it. Not asked too often: decoding takes the nodes' time away.
heard_times() {
    read -r -t 0.5 -u "$silence" || true
    [ "$(decoded | grep -c "^$1")" -ge "$2" ]
}
heard() { heard_times "$1" 1; }
# have_ranged COUNT NODES [LINES]: so many readings of each sensor of so many nodes, after so many lines of the log
have_ranged() {
    read -r -t 0.5 -u "$silence" || true
    tail -n +$((${3:-0} + 1)) "$log" >"$log.after"
    "$HIL_BIN/decode_log" "$log.after" | awk -v count="$1" -v sensors=$(($2 * 4)) '
        $2 == "range" && ++seen[$1, $3] == count { ++enough } END { exit enough < sensors }'
}
