#!/usr/bin/env python3
"""Writes PNG files (8-bit RGB) anew with a palette of 256 colours, so that they stay quick to load.

The palette is made by median cut: the box of colours with the largest sum of squared deviations is
divided where these are halved, until there are 256. Errors are diffused to the neighbours (Floyd &
Steinberg 1976), so that there are no steps and means over some pixels keep their tint. Text chunks
(the command that made the picture) stay. The root mean square of the difference, of 255, is printed
for pixels and for means over 8 x 8 of them. Only Python's standard library is needed.

Usage: reduce_colours.py FILE.png ...
"""
import bisect
import collections
import itertools
import os
import struct
import sys
import zlib

COLOURS = 256
TINT_WEIGHT = 2.0  # of differences of red or blue from green, beside 1 for grey: judged by eye


def chunks_of(data):
    position = 8
    while position < len(data):
        length, kind = struct.unpack(">I4s", data[position:position + 8])
        yield kind, data[position + 8:position + 8 + length]
        position += 12 + length


def chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def paeth(left, above, corner):
    guess = left + above - corner
    from_left, from_above, from_corner = abs(guess - left), abs(guess - above), abs(guess - corner)
    if from_left <= from_above and from_left <= from_corner:
        return left
    return above if from_above <= from_corner else corner


def rows_of(raw, width, height):
    """The rows of an RGB image without their filters (PNG specification, section 9)."""
    stride, above, rows = 3 * width, bytes(3 * width), []
    for y in range(height):
        start = y * (stride + 1)
        kind, row = raw[start], bytearray(raw[start + 1:start + 1 + stride])
        for i in range(stride if kind else 0):
            left = row[i - 3] if i >= 3 else 0
            corner = above[i - 3] if i >= 3 else 0
            guess = (0, left, above[i], (left + above[i]) // 2, 0)[kind]
            if kind == 4:
                guess = paeth(left, above[i], corner)
            row[i] = (row[i] + guess) & 255
        rows.append(row)
        above = row
    return rows


class Box:
    """Colours with their counts, and the axis on which they differ most: grey, red or blue.

    Tints count more than greys: they are few, and what a picture of nearly grey things shows."""

    AXES = ((1 / 3, 1 / 3, 1 / 3), (TINT_WEIGHT, -TINT_WEIGHT, 0), (0, -TINT_WEIGHT, TINT_WEIGHT))

    def __init__(self, colours):
        self.colours = colours
        self.count = sum(n for _, n in colours)
        self.mean = tuple(sum(c[k] * n for c, n in colours) / self.count for k in range(3))
        squares = [self.squares_along(axis) for axis in self.AXES]
        self.axis = max(range(3), key=lambda k: sum(squares[k]))
        self.spread = sum(sum(each) for each in squares)

    def squares_along(self, axis):
        a, b, c = axis
        middle = a * self.mean[0] + b * self.mean[1] + c * self.mean[2]
        return [n * (a * x[0] + b * x[1] + c * x[2] - middle) ** 2 for x, n in self.colours]

    def halves(self):
        a, b, c = self.AXES[self.axis]
        self.colours.sort(key=lambda entry: a * entry[0][0] + b * entry[0][1] + c * entry[0][2])
        squares = self.squares_along(self.AXES[self.axis])
        i = bisect.bisect_left(list(itertools.accumulate(squares)), 0.5 * sum(squares))
        i = min(max(i, 1), len(self.colours) - 1)
        return Box(self.colours[:i]), Box(self.colours[i:])


def palette_of(counts):
    boxes = [Box(list(counts.items()))]
    while len(boxes) < COLOURS:
        widest = max(boxes, key=lambda box: box.spread)
        if widest.spread == 0:
            break
        boxes.remove(widest)
        boxes.extend(widest.halves())
    return sorted(tuple(round(x) for x in box.mean) for box in boxes)


def diffused(rows, palette):
    """Indices into the palette, row by row."""
    nearest = {}

    def index_of(colour):
        if colour not in nearest:
            r, g, b = colour
            nearest[colour] = min(range(len(palette)), key=lambda i: (
                (palette[i][0] - r) ** 2 + (palette[i][1] - g) ** 2 + (palette[i][2] - b) ** 2))
        return nearest[colour]

    width = len(rows[0]) // 3
    below, indices = [0.0] * (3 * width + 6), []
    for row in rows:
        here, below = below, [0.0] * (3 * width + 6)  # errors, with a pixel more at either end
        line = bytearray(width)
        for x in range(width):
            i = 3 * x
            wanted = [min(255.0, max(0.0, row[i + k] + here[i + 3 + k])) for k in range(3)]
            line[x] = index_of(tuple(round(v) for v in wanted))
            for k, got in enumerate(palette[line[x]]):
                error = (wanted[k] - got) / 16
                if x + 1 < width:
                    here[i + 6 + k] += 7 * error
                below[i + k] += 3 * error
                below[i + 3 + k] += 5 * error
                below[i + 6 + k] += error
        indices.append(line)
    return indices


def difference(rows, indices, palette, size):
    """Root mean square of the differences of means over size x size pixels."""
    total, count = 0.0, 0
    for y in range(0, len(rows) - size + 1, size):
        for x in range(0, len(rows[0]) // 3 - size + 1, size):
            for k in range(3):
                mean = sum(rows[v][3 * u + k] - palette[indices[v][u]][k]
                           for v in range(y, y + size) for u in range(x, x + size)) / size ** 2
                total += mean * mean
                count += 1
    return (total / count) ** 0.5


def reduce(name):
    data = open(name, "rb").read()
    chunks = list(chunks_of(data))
    width, height, depth, kind = struct.unpack(">IIBB", chunks[0][1][:10])
    if kind == 3:
        return print(f"{name}: has a palette already")
    if (depth, kind, chunks[0][1][12]) != (8, 2, 0):
        sys.exit(f"{name}: not 8-bit RGB without interlacing")
    packed = b"".join(body for kind, body in chunks if kind == b"IDAT")
    rows = rows_of(zlib.decompress(packed), width, height)
    colours = collections.Counter(c for row in rows for c in zip(row[0::3], row[1::3], row[2::3]))
    palette = palette_of(colours)
    indices = diffused(rows, palette)

    # No filter: neighbours in the palette are no neighbours in colour.
    body = b"".join(b"\0" + bytes(line) for line in indices)
    out = [data[:8], chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0))]
    out += [chunk(k, b) for k, b in chunks if k not in (b"IHDR", b"IDAT", b"IEND")]
    out.append(chunk(b"PLTE", bytes(x for mean in palette for x in mean)))
    out += [chunk(b"IDAT", zlib.compress(body, 9)), chunk(b"IEND", b"")]
    with open(name + ".part", "wb") as file:
        file.write(b"".join(out))
    os.replace(name + ".part", name)
    one, eight = (difference(rows, indices, palette, size) for size in (1, 8))
    print(f"{name}: {len(data)} -> {os.path.getsize(name)} bytes; difference, of 255: pixels "
          f"{one:.2f}, 8 x 8 {eight:.2f}")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for each in sys.argv[1:]:
        reduce(each)
