#!/usr/bin/env python3
"""Writes names into pictures; what the files say of their origin stays in them. Needs matplotlib.

    captions.py balls PICTURE.png SPACING NAME ...   # under each ball; SPACING of the balls: share of the width
    captions.py grid OUT.png COLUMNS FILE.png=NAME ...   # pictures of one size beside each other, a name under each
"""
import struct
import sys
import zlib

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import font_manager, image
from matplotlib import pyplot as plt

STRIP = 0.035  # for the names below the pictures of a grid: share of the whole width


def notes_of(path):
    """The text chunks of a PNG file (PNG specification, section 11.3.4)."""
    data, position, notes = open(path, "rb").read(), 8, {}

    def add(key, text):  # a key may stand several times
        notes[key] = f"{notes[key]}\n{text}" if key in notes else text

    while position < len(data):
        length, kind = struct.unpack(">I4s", data[position:position + 8])
        body = data[position + 8:position + 8 + length]
        if kind == b"tEXt":
            key, _, text = body.partition(b"\0")
            add(key.decode("latin-1"), text.decode("latin-1"))
        elif kind == b"iTXt":
            key, _, rest = body.partition(b"\0")
            packed, (_, _, text) = rest[0], rest[2:].split(b"\0", 2)
            add(key.decode("latin-1"), (zlib.decompress(text) if packed else text).decode())
        position += 12 + length
    return notes


def write(path, pixels, names, notes, size):
    """`names`: (x, y, text) in shares of the picture, y of the text's upper edge from below."""
    height, width = pixels.shape[:2]
    figure = plt.figure(figsize=(width / 100, height / 100), dpi=100)
    figure.figimage(pixels)
    font = font_manager.FontProperties(family="DejaVu Sans", size=size * width)
    for x, y, text in names:
        figure.text(x, y, text, ha="center", va="top", color="#e8e8e8", fontproperties=font, linespacing=1.35)
    figure.canvas.draw()
    drawn = np.asarray(figure.canvas.buffer_rgba())[:, :, :3]
    image.imsave(path, drawn, metadata=notes)


def balls(path, spacing, *names):
    places = [0.5 + float(spacing) * (place - (len(names) - 1) / 2) for place in range(len(names))]
    write(path, image.imread(path)[:, :, :3], [(x, 0.16, name.replace("\\n", "\n")) for x, name in zip(places, names)],
          notes_of(path), 0.0105)


def grid(out, columns, *parts):
    files, names = zip(*(part.split("=", 1) for part in parts))
    pictures, columns = [image.imread(file)[:, :, :3] for file in files], int(columns)
    height, width = pictures[0].shape[:2]
    strip, rows = round(STRIP * width * columns), -(-len(pictures) // columns)
    whole = np.full((rows * (height + strip), columns * width, 3), pictures[0][0, 0])
    places = []
    for number, picture in enumerate(pictures):
        row, column = divmod(number, columns)
        top = row * (height + strip)
        whole[top:top + height, column * width:(column + 1) * width] = picture
        places.append(((column + 0.5) / columns, 1 - (top + height + 0.2 * strip) / whole.shape[0], names[number]))
    notes = {f"{key}, {name}": text for file, name in zip(files, names) for key, text in notes_of(file).items()}
    write(out, whole, places, notes, 0.0105)


if __name__ == "__main__":
    if len(sys.argv) < 5 or sys.argv[1] not in ("balls", "grid"):
        sys.exit(__doc__)
    {"balls": balls, "grid": grid}[sys.argv[1]](*sys.argv[2:])
