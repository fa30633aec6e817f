"""What public headers say of their names. Lists those that say too little, and fails if there are any.

- Structs, classes and functions are described: by a comment of their own, or by that of the overload above.
- Numbers say their unit or range: by their name (wavelength_nm), by their comment, or by that of
  their struct, which then names them.
- Each type and function stands in an example: a program of docs/examples, or C++ of a page or of a
  header's comment.

The Python names have tests of their own (tests/python/docs_test.py).
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
HEADERS = sorted([*ROOT.glob("*/include/miebrdf/*.h"), *ROOT.glob("*/*/include/miebrdf/*.h")])

UNIT_IN_NAME = re.compile(r"_(nm|um|deg|s|k|seconds|g_cm3|kg_m3|per_\w+|bytes)$|^(mu|cos|q|theta|seconds)(_|$)|"
                          r"(albedo|reflectance|transmittance|hdrf|asymmetry|depths?|estimate|error|ratio|iterations|index)$")  # fmt: skip
NUMBER = re.compile(r"^(?:const )?(?:std::(?:vector|optional|array)<)*"
                    r"(?:double|float|int|std::size_t|std::complex<double>)(?:[>,\d ]*>)?\s+"
                    r"(\w+)(?:\s*(?:=|\{)[^;]*)?(?:,[^;(]*)?;")  # fmt: skip
TYPE = re.compile(r"^(?:template <.*> *)?(?:struct|class|enum class) (\w+)(?: final)?(?: *: *[^{;]*)?\s*\{")
FUNCTION = re.compile(r"^(?:(?:\[\[nodiscard\]\]|inline|constexpr|static|explicit|virtual) )*[\w:<>,&*\s]+?[\s&*](\w+)\(")
NOT_FUNCTIONS = {"operator", "if", "for", "while", "switch", "return", "defined", "sizeof"}


class Name:
    def __init__(self, header, line, kind, name, comment, owner):
        self.header, self.line, self.kind, self.name = header, line, kind, name
        self.comment, self.owner = comment, owner

    def __str__(self):
        inside = f"{self.owner.name}::" if self.owner else ""
        return f"{self.header.relative_to(ROOT)}:{self.line}: {inside}{self.name}"


def names_of(header):
    """Types, functions and numbers that a header declares in public, in order."""
    lines = header.read_text(encoding="utf-8").splitlines()
    comment, last, owners, hidden, i = "", None, [], False, 0
    while i < len(lines):
        text, indent = lines[i].strip(), len(lines[i]) - len(lines[i].lstrip())
        first = i
        i += 1
        if text.startswith("///") and not text.startswith("///<"):
            comment += " " + text.lstrip("/ ")
            continue
        if not text or text.startswith(("//", "#", "}")):
            if not text or text.startswith("}"):
                comment, last = "", None
            if text.startswith("}"):
                owners = [each for each in owners if each[0] < indent]
                hidden = False if not owners or owners[-1][0] < indent else hidden
            continue
        if text in ("private:", "protected:", "public:"):
            hidden = text != "public:"
            continue
        while not re.search(r"[;{}]\s*(//.*)?$", text) and i < len(lines):  # a declaration of several lines
            text += " " + lines[i].strip()
            i += 1
        code, _, after = text.partition("//")
        while i < len(lines) and lines[i].strip().startswith("///<"):
            after += lines[i].strip()
            i += 1
        owners = [each for each in owners if each[0] < indent]
        owner = owners[-1][1] if owners else None
        said = (comment + " " + after.lstrip("/<")).strip()
        kind_of_type, number, function = TYPE.match(code), NUMBER.match(code), FUNCTION.match(code)
        if kind_of_type:
            found = Name(header, first + 1, "enum" if "enum " in code else "type", kind_of_type[1], said, owner)
            if "};" not in code:
                owners.append((indent, found))
                if hidden:
                    found.comment = "private"
        elif hidden:
            comment = ""
            continue
        elif number and owner and owner.kind == "type":
            found = Name(header, first + 1, "number", number[1], said, owner)
        elif function and function[1] not in NOT_FUNCTIONS and "using " not in code:
            if owner and function[1] == owner.name or "override" in code or "= default" in code or "= delete" in code:
                comment = ""
                continue  # constructors speak through their types
            found = Name(header, first + 1, "function", function[1], said or (last or ""), owner)
            last = found.comment
            if re.search(r"\{\s*$", code):  # its body
                while i < len(lines) and len(lines[i]) - len(lines[i].lstrip()) > indent or not lines[i].strip():
                    i += 1
        else:
            comment = ""
            continue
        comment = ""
        found.private = hidden
        if not (hidden and kind_of_type):
            yield found


def has_unit(name):
    if UNIT_IN_NAME.search(name.name) or re.search(r"[\d<>=]|\bn \+ ik|\b(um|nm|degrees?|seconds|cosines?|relative|"
            r"absolute|share|number|unit|index|depth|factor|how many|radians|sr|largest|smallest|nodes|times|as)\b|"
            r"moments|waves|standard errors?|Chebyshev|dimensions|nodes|counted|sum of|integral|lists|Lists|dimensionless|not given|directions|wavelength|values|whole number|by default|allowed|place in|components", name.comment):  # fmt: skip
        return True
    return bool(name.owner and re.search(rf"\b{name.name}\b", name.owner.comment))


def examples():
    """All C++ that is shown and compiled, or stands in a page or a header's comment."""
    text = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "docs/examples").rglob("*.cpp"))
    for page in [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]:
        text += "\n".join(re.findall(r"```cpp\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL))
    for header in HEADERS:
        text += "\n".join(line for line in header.read_text(encoding="utf-8").splitlines() if line.startswith("//     "))
    return set(re.findall(r"\w+", text))


def main():
    shown, wrong, count = examples(), [], 0
    for header in HEADERS:
        for name in names_of(header):
            count += 1
            if name.kind not in ("number", "enum") and not name.comment:
                wrong.append(f"{name}: not described")
            if name.kind == "number" and not has_unit(name):
                wrong.append(f"{name}: no unit or range ({name.comment or 'no comment'})")
            if name.kind != "number" and name.owner is None and name.name not in shown:
                wrong.append(f"{name}: in no example")
    print("\n".join(wrong) or f"{count} public names in {len(HEADERS)} headers are described")
    if count < 500:
        print(f"only {count} names found: this script does not understand the headers any more")
    return 1 if wrong or count < 500 else 0


if __name__ == "__main__":
    sys.exit(main())
