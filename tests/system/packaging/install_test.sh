#!/bin/sh
# install_test.sh CMAKE BUILD: `cmake --install` stays below its prefix, names it in the units, leaves settings that somebody
# changed, and installs a program that finds its data.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
install() { "$1" --install "$2" --prefix "$folder/prefix" > "$folder/log"; }
install "$1" "$2"
test "$(ls "$folder/prefix" | tr '\n' ' ')" = "bin etc lib libexec share "
for name in octoskin octoskin-node; do
    grep -q "^ExecStart=$folder/prefix/bin/$name " "$folder/prefix/lib/systemd/system/$name.service"
    grep -q "^EnvironmentFile=$folder/prefix/etc/default/$name\$" "$folder/prefix/lib/systemd/system/$name.service"
done
"$folder/prefix/bin/octoskin" rig "$folder/prefix/share/octoskin/hw/rigs/experiment.yaml" > /dev/null
"$folder/prefix/bin/octoskin" simulate --help | grep -qF "$folder/prefix/share/octoskin/hw/rigs/experiment.yaml"
echo "OCTOSKIN_CAN=can9" >> "$folder/prefix/etc/default/octoskin"
install "$1" "$2"
grep -q "^OCTOSKIN_CAN=can9\$" "$folder/prefix/etc/default/octoskin"
