#!/usr/bin/env python3
"""links_test.py FOLDER: every relative link of every Markdown document below FOLDER leads to a file or folder that is there, and
to a heading that the document has. Says how many it followed."""
import functools
import pathlib
import re
import sys

LINK = re.compile(r"\]\(([^()\s]+)\)")
LEFT_OUT = {"build", "out", ".git"}  # of a source tree


def prose(document):
    """Its lines without blocks of code."""
    in_code = False
    for line in document.read_text(encoding="utf-8").splitlines():
        if line.lstrip().startswith("```"):
            in_code = not in_code
        elif not in_code:
            yield line


@functools.lru_cache(maxsize=None)
def anchors(document):
    """As GitHub makes them of headings: letters, digits, - and _, a repeated one with a number."""
    found = {}
    for line in prose(document):
        if match := re.match(r"#+ +(.*)", line):
            words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", match[1]).strip().lower()
            anchor = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
            found[anchor] = found.get(anchor, -1) + 1
            if found[anchor] > 0:
                found[f"{anchor}-{found[anchor]}"] = 0
    return set(found)


def fault(document, link):
    path, _, anchor = link.partition("#")
    target = (document.parent / path).resolve() if path else document
    if not target.exists():
        return "leads to nothing"
    if anchor and anchor not in anchors(target):
        return f"there is no such heading in {target.name}"
    return None


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    followed = 0
    faults = []
    for document in sorted(folder.rglob("*.md")):
        if LEFT_OUT & set(document.relative_to(folder).parts):
            continue
        for line in prose(document):
            for link in LINK.findall(re.sub(r"`[^`]*`", "", line)):
                if re.match(r"[a-z]+:", link):
                    continue
                followed += 1
                if what := fault(document, link):
                    faults.append(f"{document.relative_to(folder)}: ({link}) {what}")
    print("\n".join(faults))
    print(f"{followed} links followed, {len(faults)} dead")
    return 1 if faults or followed == 0 else 0


sys.exit(main())
