#!/bin/sh
# unit_test.sh SYSTEMD-ANALYZE UNIT PROGRAM: systemd understands every line of the unit, with the program where it is
# built; and a line that it does not understand is found.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
sed "s|/usr/bin/octoskin|$3|" "$2" > "$folder/octoskin.service"
said=$("$1" verify --man=no "$folder/octoskin.service" 2>&1 | grep "octoskin.service" || true)
if [ -n "$said" ]; then
    echo "$said"
    exit 1
fi
sed "s|^ProtectHome=|ProtectHomes=|" "$folder/octoskin.service" > "$folder/wrong.service"
"$1" verify --man=no "$folder/wrong.service" 2>&1 | grep -q ProtectHomes
