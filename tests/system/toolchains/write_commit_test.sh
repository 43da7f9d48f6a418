#!/usr/bin/env bash
# The commit in the program: of a clone, of a clone with changes, of a tarball, and of a tarball unpacked in somebody
# else's clone; and a file that is touched only when it changes. Usage: write_commit_test.sh CMAKE SOURCE_DIR
set -euo pipefail
cmake=$1
script=$2/toolchains/write_commit.cmake
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "write_commit_test: $*" >&2; cat "$work/commit.cpp" >&2; exit 1; }
write() { "$cmake" -DSOURCE_DIR="$1" -DOUT="$work/commit.cpp" -P "$script"; }
says() { grep -qF "kCommit = \"$1\"" "$work/commit.cpp" && grep -qF "kIsCommitChanged = $2;" "$work/commit.cpp"; }

mkdir "$work/tarball"
write "$work/tarball"
says unknown false || fail "a tarball has a commit"

git init -q "$work/clone"
cd "$work/clone"
mkdir inner
echo one >file
git add file
git -c user.name=test -c user.email=test@example.org commit -qm one
commit=$(git rev-parse --short=12 HEAD)
write "$work/clone"
says "$commit" false || fail "a clone has not its own commit"
touch -d '2001-01-01' "$work/commit.cpp"
write "$work/clone"
[ "$(stat -c %Y "$work/commit.cpp")" -lt 1000000000 ] || fail "is touched though nothing changed"
echo two >file
write "$work/clone"
says "$commit" true || fail "a change is not seen"
write "$work/clone/inner"
says unknown false || fail "a tarball in somebody else's clone has its commit"
