#!/bin/sh
# install_test.sh CMAKE BUILD: `cmake --install` stays below its prefix, names it in the units, leaves settings that somebody
# changed, installs a program that finds its data and its module, and documents whose links lead somewhere.
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
"$folder/prefix/bin/octoskin-lab" simulate --help | grep -qF "$folder/prefix/share/octoskin/hw/rigs/experiment.yaml"
# No file names the folder that it was built in, and no program that of the sources alone: what is looked for there, another user may put
# there. (What an assertion says of itself names a source.)
sources=$(cd "$(dirname "$0")/../../.." && pwd)
if grep -rlF -e "$2" "$folder/prefix"; then
    echo "the files above name the build folder" >&2
    exit 1
fi
for program in "$folder"/prefix/bin/* "$folder"/prefix/libexec/octoskin/octoskin-*; do
    if strings -a "$program" | grep -xF -e "$sources" -e "$sources/"; then
        echo "$program names the folder of the sources" >&2
        exit 1
    fi
done
# No program looks for libraries in the working directory: an empty or relative part of a search path means that. Where it was
# built neither.
for program in "$folder"/prefix/bin/* "$folder"/prefix/libexec/octoskin/octoskin-* "$2"/bin/octoskin*; do
    if readelf -d "$program" | sed -n 's/.*Library r[un]*path: \[\(.*\)\]$/\1/p' | tr : '\n' | grep -v '^[$/]'; then
        echo "$program looks for libraries in the working directory" >&2
        exit 1
    fi
done
# A world is read by a helper, in a process of its own, and that by a module, so that a file which is no world at all waits for no
# library; without either that is said.
ldd "$folder/prefix/bin/octoskin-lab" > "$folder/libraries"
if grep -q sdformat "$folder/libraries"; then exit 1; fi
# The product has nothing of the laboratory.
ldd "$folder/prefix/bin/octoskin" > "$folder/libraries"
# Nor a network library: only the bridge, a program of its own, speaks DDS.
if grep -qE 'sdformat|embree|assimp|ddsc|boost' "$folder/libraries"; then exit 1; fi
simulate() {
    "$folder/prefix/bin/octoskin-lab" simulate "$folder/$1" --rig "$folder/prefix/share/octoskin/hw/rigs/bench_one_board.yaml" \
        --scenario "$folder/prefix/share/octoskin/hw/worlds/bench.scenario.yaml" > "$folder/log" 2>&1
}
simulate recording
mv "$folder/prefix/libexec/octoskin/octoskin-sdf.so" "$folder/module"
if simulate none; then exit 1; fi
grep -q "the reader of SDF files cannot be loaded.*octoskin-sdf.so.* install octoskin anew" "$folder/log"
mv "$folder/module" "$folder/prefix/libexec/octoskin/octoskin-sdf.so"
/usr/bin/python3 "$(dirname "$0")/links_test.py" "$folder/prefix/share/doc/octoskin"
documents=$folder/prefix/share/doc/octoskin
grep -qF "](../../packaging/README.md)" "$documents/docs/start/beside-a-robot.md"
grep -qF "](../hw/worlds/bench.scenario.yaml)" "$documents/docs/scenario.md"
grep -qF "| common/ |" "$documents/README.md"
echo "OCTOSKIN_CAN=can9" >> "$folder/prefix/etc/default/octoskin"
install "$1" "$2"
grep -q "^OCTOSKIN_CAN=can9\$" "$folder/prefix/etc/default/octoskin"
