#!/bin/sh
# unit_test.sh SYSTEMD-ANALYZE UNIT PROGRAM: systemd understands every line of the unit, with the program where it is
# built; and a line that it does not understand is found.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
name=$(basename "$2")
sed "s|^ExecStart=[^ ]*|ExecStart=$3|" "$2" > "$folder/$name"
said=$("$1" verify --man=no "$folder/$name" 2>&1 | grep "$name" || true)
if [ -n "$said" ]; then
    echo "$said"
    exit 1
fi
if ! sed -n '/^\[Unit\]/,/^\[Service\]/p' "$2" | grep -q '^StartLimitIntervalSec=0$'; then
    echo "$name: a service that fails five times in ten seconds would be given up for good"
    exit 1
fi
# A loop that hangs is found: the service says that it is ready, and then that it goes on.
for line in Type=notify NotifyAccess=main WatchdogSec=10; do
    if ! grep -qx "$line" "$2"; then
        echo "$name: no $line"
        exit 1
    fi
done
sed "s|^ProtectHome=|ProtectHomes=|" "$folder/$name" > "$folder/wrong.service"
"$1" verify --man=no "$folder/wrong.service" 2>&1 | grep -q ProtectHomes
