#!/usr/bin/env python3
"""Relative links and anchors of every page lead somewhere, and every picture has a text in its place.

Links to other servers are not followed: what they say today is not a property of this project.
"""

import re
import sys

import pages

LINK = re.compile(r"\]\(\s*<?([^)\s>]+)>?[^)]*\)")
SOURCE = re.compile(r"""(?:src|href)=["']([^"']+)["']""")
CODE = re.compile(r"`[^`]*`")
# A picture without words: no text between the brackets, no alt, or the name of the file alone.
WORDLESS = re.compile(r"""!\[\s*(?:[\w.-]+\.(?:png|svg))?\s*\]\(|<img\b(?![^>]*\balt="[^"]*\w)""")


def anchor_of(heading):
    """The anchor that hosts of Markdown give a heading: lower case, blanks to hyphens, the rest of
    the punctuation left out."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)  # a link's text
    text = text.replace("`", "").replace("*", "").strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def anchors_of(page):
    found = {}
    anchors = set()
    for _, line, fence in pages.lines_of(page):
        if fence is not None:
            continue
        anchors.update(re.findall(r"""<a (?:id|name)=["']([^"']+)["']""", line))
        heading = re.match(r"#{1,6} (.*)", line)
        if not heading:
            continue
        anchor = anchor_of(heading.group(1))
        count = found.get(anchor, 0)
        found[anchor] = count + 1
        anchors.add(anchor if count == 0 else f"{anchor}-{count}")
    return anchors


def links_of(page):
    """(number, target) of every link; a link's text may run over the end of a line."""
    text, numbers = "", []
    for number, line, fence in pages.lines_of(page):
        if fence is None:
            line = CODE.sub("``", line) + "\n"
            text += line
            numbers += [number] * len(line)
    for pattern in (LINK, SOURCE):
        for match in pattern.finditer(text):
            yield numbers[match.start()], match.group(1)


def problem_of(page, target):
    """What is wrong with a link of this page; None if nothing is."""
    if re.match(r"[a-z][a-z0-9+.-]*:", target):
        return None
    path, _, anchor = target.partition("#")
    file = page if not path else (page.parent / path)
    if not file.exists():
        return "there is no such file"
    if anchor and file.suffix == ".md" and anchor not in anchors_of(file):
        return f"no heading has the anchor #{anchor}"
    return None


def main():
    count = 0
    problems = []
    for page in pages.pages():
        for number, target in links_of(page):
            count += 1
            problem = problem_of(page, target)
            if problem:
                problems.append(f"{page.relative_to(pages.ROOT)}:{number}: {target}: {problem}")
        for number, line, fence in pages.lines_of(page):
            if fence is None and WORDLESS.search(line):
                problems.append(f"{page.relative_to(pages.ROOT)}:{number}: a picture without an alternative text")
    print("\n".join(problems))
    print(f"{count} links, {len(problems)} broken")
    if count < 100:
        sys.exit("far too few links: are the pages where they should be?")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
