#!/bin/sh
# no_shared_folder_test.sh SOURCE: no document has anybody write to a name in /tmp that somebody else can take first, with a
# link in it. `mktemp -d` makes a folder of one's own.
set -eu
cd "$1"
if grep -nE '(^|[^A-Za-z0-9_./])(/var)?/(tmp|dev/shm)/' ./*.md docs/*.md docs/*/*.md ./*/README.md packaging/man/* hw/rigs/*.yaml; then
    echo "a name in a folder that all share: use mktemp -d, or a folder of the user's own"
    exit 1
fi
