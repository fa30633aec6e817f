#!/usr/bin/env python3
r"""Formulas of the pages, $...$ and $$...$$, survive Markdown: forges read it before they read TeX.

Emphasis begins at an underscore after punctuation ("}_"), backslashes before punctuation vanish
("\,"), "|" ends a cell of a table, and lines that begin with an operator are lists or headings.
"""

import re
import sys

import pages

CODE = re.compile(r"`[^`]*`")
FORMULA = re.compile(r"\$([^$]+)\$")
RULES = [
    (re.compile(r"(?<![A-Za-z0-9])_"), "an underscore after something else than a letter or digit begins emphasis"),
    (re.compile(r"\\[^A-Za-z\s\\]"), "Markdown takes a backslash before punctuation away"),
    (re.compile(r"\*"), r"an asterisk begins emphasis: \ast"),
    (re.compile(r"\|"), r"a bar ends a cell: \lvert, \rvert"),
    (re.compile(r"[<>](?! )"), "without a blank behind it this begins a tag"),
]


def problems_of(page):
    displayed, paragraph, start = None, "", 0
    for number, line, fence in [*pages.lines_of(page), (0, "", None)]:
        if fence is not None:
            continue
        text = CODE.sub("``", line)
        if text.strip() == "$$":
            displayed = number if displayed is None else None
        elif displayed is not None:
            if not text.strip() or re.match(r"\s*[-+=*#>]", text):
                yield number, "a line of a displayed formula begins with a letter or a backslash"
            for rule, why in RULES:
                if rule.search(text):
                    yield number, f"{why}: {text.strip()[:60]}"
        elif text.strip() and not text.startswith("|"):
            paragraph, start = f"{paragraph} {text}", start or number
        else:
            for part, where in ((paragraph, start), (text, number)):
                for match in FORMULA.finditer(part):
                    formula = match.group(1)
                    if re.match(r"[A-Za-z0-9]", part[match.start() - 1:]) and match.start() > 0:
                        yield where, f"a letter or digit before it keeps the formula from being set: ${formula}$"
                    for rule, why in (*RULES, (re.compile(r"\\\\|^\s|\s$"), "no line breaks or blanks at the ends")):
                        if rule.search(formula):
                            yield where, f"{why}: ${formula}$"
                if part.count("$") % 2:
                    yield where, "a dollar sign without its pair"
            paragraph, start = "", 0
    if displayed is not None:
        yield displayed, "a displayed formula without an end"


def main():
    wrong = [f"{page.relative_to(pages.ROOT)}:{number}: {what}" for page in pages.pages() for number, what in problems_of(page)]
    print("\n".join(wrong) if wrong else "every formula can be set")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
