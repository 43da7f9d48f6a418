#!/usr/bin/env python3
"""Tests the unit tests: changes one thing at a time in common/, firmware/drivers/ or firmware/core/, builds the room's
unit test and looks whether it notices.

    tests/mutation/mutate.py --count 100 --seed 1             # one line per mutant, then the sum; ~10 s each
    tests/mutation/mutate.py --only firmware/core/reflex.cpp  # every mutant of one file
    tests/mutation/mutate.py --only 'common/*.cpp' --count 50

A mutant is killed if a test fails, crashes or hangs. One that survives shows a missing test, or changes nothing that
could be seen (an *equivalent* mutant), or moves a constant that is free to be chosen: a reader must say which. Asserts and
what only the compiler reads are not mutated. It works on the files themselves and puts each back.
"""
import argparse
import fnmatch
import os
import random
import re
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "mutation"
ROOMS = ("common", "firmware/drivers", "firmware/core")
TESTS = {  # by the start of a path, the first that fits: the smallest test that has to notice
    "common/wire/socketcan_layout": "tests/unit/host/io/socketcan/socketcan_test",
    "common/": "tests/unit/common/common_test",
    "firmware/drivers/": "tests/unit/firmware/drivers/vl53l1x/vl53l1x_test",
    "firmware/core/": "tests/unit/firmware/core/node_test",
}
# clang-format puts blanks around every binary operator and around no template bracket or reference.
SWAPS = {
    "<": ["<=", ">="], "<=": ["<", ">"], ">": [">=", "<="], ">=": [">", "<"], "==": ["!="], "!=": ["=="],
    "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"], "%": ["*"], "&&": ["||"], "||": ["&&"], "|": ["&"], "&": ["|"], "^": ["|"],
    "<<": [">>"], ">>": ["<<"], "+=": ["-="], "-=": ["+="], "|=": ["&="], "&=": ["|="], "^=": ["|="],
}
OPERATOR = re.compile(r"(?<= )(" + "|".join(sorted(map(re.escape, SWAPS), key=len, reverse=True)) + r")(?=[ \n])")
NUMBER = re.compile(r"(?<![\w.'\"])(0[xX][0-9a-fA-F']+|\d[\d']*)(?=[uUlL]*(?![\w.']))")
OPPOSITES = {"true": "false", "false": "true", "++": "--", "--": "++"}
WORD = re.compile(r"\b(?:true|false)\b|\+\+|--")
NEGATION = re.compile(r"(?<![\w)])!(?=[\w(])")
CONDITION = re.compile(r"(?:(?<=\bif \()|(?<=\bwhile \())(?:[^();]|\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\))+(?=\))")
STATEMENT = re.compile(r"(?<=[;{}]\n)[ ]+(?:[\w.\[\]]+(?:->[\w.]+)* [-+|&]?=|[\w.:]+(?:->[\w.:]+)*\(|\+\+|--|return;)[^;{}]*;(?=\n)")
UNREAD = re.compile(r"""//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])'|^[ ]*\#[^\n]*|\b(?:static_)?assert\([^;]*;|\[\[[^\]]*\]\]""",
                    re.DOTALL | re.MULTILINE)


def blanked(text):
    """The text, as long as before, without what is not mutated."""
    return UNREAD.sub(lambda m: re.sub(r"[^\n]", " ", m.group()), text)


def changes(text):
    """All mutants of a file's text: (start, end, replacement)."""
    code = blanked(text)
    for m in OPERATOR.finditer(code):
        yield from ((m.start(), m.end(), to) for to in SWAPS[m.group()])
    for m in NUMBER.finditer(code):
        value = int(m.group().replace("'", ""), 0)
        yield from ((m.start(), m.end(), str(to)) for to in (value + 1, value - 1) if to >= 0)
    for m in WORD.finditer(code):
        yield m.start(), m.end(), OPPOSITES[m.group()]
    for m in NEGATION.finditer(code):
        yield m.start(), m.end(), ""
    for m in CONDITION.finditer(code):
        yield m.start(), m.end(), "!(" + text[m.start():m.end()] + ")"
    for m in STATEMENT.finditer(code):
        yield m.start(), m.end(), ""


def run(command, limit_s):
    """The exit status; a program that takes too long has failed."""
    try:
        return subprocess.run(command, cwd=BUILD, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=limit_s,
                              env={**os.environ, "GTEST_FAIL_FAST": "1"}, check=False).returncode
    except subprocess.TimeoutExpired:
        return -1


def verdict(test, limit_s):
    if run(["ninja", test.split("/")[-1]], 900) != 0:
        return "does not compile"
    return "killed" if run([BUILD / test], limit_s) != 0 else "SURVIVED"


def test_of(path):
    return next(test for start, test in TESTS.items() if str(path.relative_to(ROOT)).startswith(start))


def judge(path, mutants, limit_s):
    """Yields (where, what, verdict) of each mutant of one file, and leaves the file as it was."""
    text = path.read_text()
    try:
        for start, end, to in mutants:
            was = text[start:end]
            at = end - len(was.lstrip())
            where = f"{path.relative_to(ROOT)}:{text.count(chr(10), 0, at) + 1}:{at - text.rfind(chr(10), 0, at)}"
            path.write_text(text[:start] + to + text[end:])
            yield where, f"{' '.join(was.split())} -> {to or 'nothing'}", verdict(test_of(path), limit_s)
    finally:
        path.write_text(text)


def time_limit_s(test):
    """What the test may take with a mutant in it; unchanged it must pass."""
    subprocess.run(["ninja", "-C", BUILD, test.split("/")[-1]], check=True, stdout=subprocess.DEVNULL)
    began = time.monotonic()
    subprocess.run([BUILD / test], check=True, stdout=subprocess.DEVNULL)
    return 10 + 5 * (time.monotonic() - began)


def sample(only, count, seed):
    """The chosen mutants by file: all of the files that fit, or `count` of them, equally likely."""
    files = [p for room in ROOMS for p in sorted((ROOT / room).rglob("*.[ch]pp"))
             if fnmatch.fnmatch(str(p.relative_to(ROOT)), only)]
    every = [(p, *change) for p in files for change in changes(p.read_text())]
    chosen = every if count is None else random.Random(seed).sample(every, min(count, len(every)))
    print(f"{len(chosen)} of {len(every)} mutants in {len(files)} files", flush=True)
    return {p: sorted(m[1:] for m in chosen if m[0] == p) for p in sorted({m[0] for m in chosen})}


def main():
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--only", default="*", help="pattern of paths, from the root")
    ask.add_argument("--count", type=int, help="so many, at random; without it all")
    ask.add_argument("--seed", type=int, default=1, help="of the choice")
    arguments = ask.parse_args()
    if subprocess.run(["git", "diff", "--quiet", "HEAD"], cwd=ROOT, check=False).returncode != 0:
        sys.exit("the work tree has changes: commit them first")
    # The library's own assertions: reading past an array's end is noticed, whatever lies there.
    subprocess.run(["cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug",
                    "-DCMAKE_CXX_FLAGS_DEBUG=-O0 -w -D_GLIBCXX_ASSERTIONS"], check=True, stdout=subprocess.DEVNULL)
    chosen = sample(arguments.only, arguments.count, arguments.seed)
    limits = {test: time_limit_s(test) for test in {test_of(path) for path in chosen}}
    sums = Counter()
    for path, mutants in chosen.items():
        for where, what, said in judge(path, mutants, limits[test_of(path)]):
            sums[said] += 1
            print(f"{said:16} {where}: {what}", flush=True)
    print(", ".join(f"{count} {said}" for said, count in sums.most_common()))


if __name__ == "__main__":
    main()
