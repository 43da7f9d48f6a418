# shellcheck shell=bash
# What the checks share; sourced by each. board.sh says how the board is wired.
set -euo pipefail
background=()
trap 'kill "${background[@]}" 2>/dev/null || true' EXIT

fail() { echo "FAILED: $*"; exit 1; }

# expect WHAT WANTED GOT
expect() { [ "$2" = "$3" ] || fail "$1: wanted '$2', got '$3'"; }

# The emulated processor is slow, and its host may be busy: this long for what takes a tenth of a second.
patience_s=60
# A wait without a process.
exec {silence}<> <(:)
nap() { read -r -t 0.02 -u "$silence" || true; }

# await WHAT COMMAND...: asks until the command succeeds.
await() {
    local what=$1 end=$((SECONDS + patience_s))
    shift
    until "$@" >/dev/null 2>&1; do
        [ $SECONDS -lt $end ] || fail "$what did not come within $patience_s s"
        nap
    done
}

# The other end of a GPIO line: what it is driven to, and what drives it.
level() { echo "$(<"$HIL_LINES/sim_gpio$1/value")"; }
pull() { echo "pull-$2" >"$HIL_LINES/sim_gpio$1/pull"; }
is_level() { [ "$(<"$HIL_LINES/sim_gpio$1/value")" = "$2" ]; }

# drive LINE=LEVEL...: until `let_go` or the end of the check.
drive() {
    gpioset --mode=signal "$HIL_CHIP" "$@" &
    driver=$!
    background+=("$driver")
    local line
    for line in "$@"; do await "line $line" is_level "${line%=*}" "${line#*=}"; done
}
let_go() {
    kill "$driver"
    wait "$driver" || true
}

# transfer BUS MESSAGE...: prints the bytes read, as i2c-tools' i2ctransfer says them.
transfer() { i2ctransfer -y "$@"; }
is_there() { transfer "$1" w2@"$2" 0x01 0x0f r2; }

# refused WHY COMMAND...: fails, and says why.
refused() {
    local why=$1 said
    shift
    if said=$("$@" 2>&1); then fail "'$*' was answered: $said"; fi
    [[ $said == *"$why"* ]] || fail "'$*' failed, but said: $said"
}
