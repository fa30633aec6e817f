#!/usr/bin/env python3
"""Files of the collections -> materials/data/sopra, materials/data/rii: the rows that the sources give.

    from_collections.py SOPRA_FOLDER RII_DATABASE [NK_FOLDER]

SOPRA_FOLDER    the SOPRA tables as TFCalc .MAT files (github.com/qpv-research-group/solcore5,
                solcore/material_data/SOPRA_DB); wavelengths there are rounded to nine digits, so the
                even grid that the original file states is put back, and checked against them
RII_DATABASE    folder `database` of github.com/polyanskiy/refractiveindex.info-database (CC0); files are
                taken over byte for byte
NK_FOLDER       original SOPRA .nk files, preferred where there are any
"""
import csv
import pathlib
import re
import sys

HC = 1239.851815  # eV nm, with which those .MAT files were made (0.5 eV is 2479.70363 nm there)
DATA = pathlib.Path(__file__).resolve().parent


def read_mat(path):
    rows = []
    for line in path.read_text(errors="replace").splitlines():
        fields = line.split("*")
        if fields[0] == "DATA1":
            rows.append([float(f) for f in fields[2:5]])
    return rows


def even_grid(wavelengths_nm):
    """(code, first, last) of the unit in which the rows are even."""
    for code, to_unit in ((1, lambda w: HC / w), (2, lambda w: w / 1000)):
        x = sorted(to_unit(w) for w in wavelengths_nm)
        first, last = (float(f"{end:.4g}") for end in (x[0], x[-1]))
        steps = len(x) - 1
        if all(abs(v / (first + (last - first) * i / steps) - 1) < 2e-8 for i, v in enumerate(x)):
            return code, first, last
    return None


def short(number):
    return f"{number:.9g}"


def write_sopra(key, mat, nk_files, target):
    nk = nk_files.get(key.lower())
    if nk is not None:
        target.write_bytes(nk.read_bytes())
        return
    rows = read_mat(mat)
    grid = even_grid([row[0] for row in rows])
    if grid is None:
        raise SystemExit(f"{mat}: no even grid")
    code, first, last = grid
    if code == 1:
        rows.reverse()
    lines = [f"{code} {short(first)} {short(last)} {len(rows) - 1}"]
    lines += [f"{short(n)} {short(k)}" for _, n, k in rows]
    target.write_text("\n".join(lines) + "\n")


def main():
    sopra, rii = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    nk_files = {}
    if len(sys.argv) > 3:
        nk_files = {p.stem.lower(): p for p in pathlib.Path(sys.argv[3]).iterdir()}
    with open(DATA / "index.csv", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    for row in rows:
        target = DATA / row["file"]
        target.parent.mkdir(exist_ok=True)
        if row["source"] == "SOPRA":
            mat = next(sopra.rglob(row["from"] + ".MAT"))
            write_sopra(row["from"], mat, nk_files, target)
        elif row["source"] == "refractiveindex.info":
            text = (rii / "data" / row["from"]).read_bytes()
            if row["longest_um"]:
                text = cut(text.decode(), float(row["longest_um"])).encode()
            target.write_bytes(text)


def cut(text, longest_um):
    """Leaves out the table rows beyond a wavelength."""
    kept = []
    for line in text.splitlines(keepends=True):
        row = re.match(r"\s+([0-9.]+)\s+[-0-9.]", line)
        if row is None or float(row.group(1)) <= longest_um:
            kept.append(line)
    return "".join(kept)


if __name__ == "__main__":
    main()
