#!/usr/bin/env python3
"""Every place in the documentation that code or a page points to exists.

Code, tests and scripts cite pages by path, and headings in quotation marks after it:
docs/physics.md, "Contact" and "Self-folding". Pages link to each other, and to headings by anchor.
Fails with one line for each citation or link that leads nowhere: citations.py FOLDER, a
checkout, or documents as they are installed, which come without tests.
"""

import pathlib
import re
import subprocess
import sys

CITED = re.compile(
    r'((?:docs|benchmarks|bindings|examples|records|tests)/[\w./-]*\w\.md)((?:(?:,| and|, and|;) "[^"]+")*)')
LINK = re.compile(r"\]\(([^)\s]+)\)")
COMMENT = re.compile(r"\n[ \t]*(?://|#|\*)?[ \t]*")  # a citation may run over the end of a line
CODE = (".cpp", ".h", ".py", ".sh", ".bash", ".bats", ".mk", ".awk", ".jq", ".cmake", ".txt", ".yaml",
        ".in", ".js")


def headings(page: pathlib.Path) -> list[str]:
    found, fenced = [], False
    for line in page.read_text().splitlines():
        if line.startswith("```"):
            fenced = not fenced
        elif not fenced and (match := re.match(r"#{1,6} +(.*?)\s*$", line)):
            found.append(match[1].replace("`", ""))
    return found


def anchors(page: pathlib.Path) -> set[str]:
    """As GitHub makes them: a heading met again gets a number."""
    made: list[str] = []
    for heading in headings(page):
        text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower()
        made.append(re.sub(r"[^\w\- ]", "", text).replace(" ", "-"))
    numbered = {a if (n := made[:i].count(a)) == 0 else f"{a}-{n}" for i, a in enumerate(made)}
    return numbered | set(re.findall(r'<a (?:id|name)="([^"]+)"', page.read_text()))


def bad_citations(root: pathlib.Path, name: str) -> list[str]:
    text = COMMENT.sub(" ", (root / name).read_text(errors="replace"))
    bad = []
    for path, quoted in CITED.findall(text):
        page = root / path
        if not page.is_file():
            bad.append(f"{name}: cites {path}, which does not exist")
            continue
        bad += [f'{name}: cites {path}, "{heading}", a heading that it does not have'
                for heading in re.findall(r'"([^"]+)"', quoted) if heading not in headings(page)]
    return bad


def bad_links(root: pathlib.Path, name: str) -> list[str]:
    text = re.sub(r"```.*?```|`[^`\n]*`", "", (root / name).read_text(), flags=re.DOTALL)
    bad = []
    for link in LINK.findall(text):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = (root / name).parent / path if path else root / name
        if "/tests/" in path and not (root / "tests").exists():
            continue
        if not target.exists():
            bad.append(f"{name}: links to {link}, which does not exist")
        elif anchor and target.suffix == ".md" and anchor not in anchors(target):
            bad.append(f"{name}: links to {link}, a heading that it does not have")
    return bad


def main() -> None:
    root = pathlib.Path(sys.argv[1])
    checkout = (root / ".git").exists()
    if checkout:
        listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
        names = subprocess.run(listed, cwd=root, capture_output=True, text=True, check=True).stdout.split("\n")
    else:
        names = [str(page.relative_to(root)) for page in root.rglob("*.md")]
    bad, cited, linked = [], 0, 0
    for name in filter(None, names):
        file = root / name
        if not file.is_file() or name == "tests/citations.py":
            continue
        if name.endswith(".md"):
            linked += 1
            bad += bad_links(root, name)
        elif name.endswith(CODE) or (name.startswith("scripts/") and "." not in file.name):
            cited += 1
            bad += bad_citations(root, name)
    print(*bad, sep="\n")
    if not linked or (checkout and not cited):
        sys.exit(f"{root}: no code or no page to look at")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
