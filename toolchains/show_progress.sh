# For ./demo, ./check and firmware/flash, which source it: show_progress LOG COMMAND... runs a build with all output in
# LOG, and shows its progress: on a terminal ninja's count and the time in one line that is cleared at the end; elsewhere
# a line at every tenth. Returns the exit code of COMMAND. The watcher runs in the background, not the build: Ctrl-C must
# reach the build.

watch_progress() {
    local log=$1 start=$SECONDS count tenth tenths=0
    while sleep 1; do
        count=$(grep -aoE '^\[[0-9]+/[0-9]+\]' "$log" | tail -n 1 | tr -d '[]') || true
        [ -n "$count" ] || continue
        tenth=$((10 * ${count%/*} / ${count#*/}))
        if [ -t 1 ]; then
            printf '\r   %s steps, %d s ' "$count" $((SECONDS - start))
        elif [ "$tenth" -gt "$tenths" ]; then
            tenths=$tenth
            printf '   %d %%: %s steps, %d s\n' $((10 * tenth)) "$count" $((SECONDS - start))
        fi
    done
}

show_progress() {
    local log=$1 watcher outcome=0
    shift
    : >"$log"
    watch_progress "$log" &
    watcher=$!
    "$@" >>"$log" 2>&1 || outcome=$?
    kill "$watcher" 2>/dev/null || true
    wait "$watcher" 2>/dev/null || true
    [ ! -t 1 ] || printf '\r%40s\r' ''
    return "$outcome"
}
