#!/usr/bin/env bash
# firmware/flash answers at once what needs no building; its usage has every option of `octoskin flash`.
# usage: flash_script_test.sh SOURCE
set -euo pipefail
script=$1/firmware/flash
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() { echo "FAILED: $1" >&2; exit 1; }

# Nothing can be built there: only the shell's own programs are found.
mkdir "$folder/bin"
for program in bash cat dirname; do ln -s "$(command -v "$program")" "$folder/bin/"; done
answer() { # what it says, and its exit code as the last line
    local code=0
    PATH=$folder/bin "$script" "$@" 2>&1 || code=$?
    echo "$code"
}

for word in --help -h; do
    said=$(answer --rig gone.yaml "$word")
    [[ $said == "usage: firmware/flash "* && $said == *$'\n0' ]] || fail "$word: $said"
done
[[ $(answer --rig "$folder/gone.yaml" --node a) == "firmware/flash: $folder/gone.yaml: no such file"$'\n66' ]] || fail "a rig that is not there"
[[ $(answer "--rig=$folder/gone.yaml") == *"no such file"$'\n66' ]] || fail "a rig that is not there, with ="
[[ $(answer --node a) == *"--rig is missing"*$'\n64' ]] || fail "no rig"

usage=$(answer --help)
options=$(grep -o '"--[a-z-]*"' "$1/host/apps/octoskin/flash_command.cpp" | tr -d '"' | sort -u)
[ -n "$options" ] || fail "no option of octoskin flash was found"
for option in $options; do
    [[ $usage == *"  $option "* ]] || fail "the usage lacks $option"
done
