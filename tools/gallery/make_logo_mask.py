#!/usr/bin/env python3
"""Draws docs/examples/logo_mask.png: the word "miebrdf" on a ground twice as wide as high.

Black is the ground, mid-grey the left half of the word and white the right half, so that
`miebrdf render --mask` lays a material of its own on each. No grey steps along the edges: they
would be taken for other materials. Only Python's standard library is needed.

Usage: make_logo_mask.py FILE.png
"""
import math
import struct
import sys
import zlib

WIDTH, HEIGHT = 1200, 600
STROKE = 0.15  # half the width of a stroke, in x-heights
MARGIN = 0.07  # of the width, left and right

# Letters in units of the x-height, baseline at y = 0: lines (x0, y0, x1, y1) and arcs
# (centre x, centre y, radius, first angle, last angle), degrees counter-clockwise; advance width.
LETTERS = {
    "m": ([(0, 0, 0, 1), (0.8, 0, 0.8, 0.6), (1.6, 0, 1.6, 0.6)],
          [(0.4, 0.6, 0.4, 0, 180), (1.2, 0.6, 0.4, 0, 180)], 1.6),
    "i": ([(0, 0, 0, 1), (0, 1.5, 0, 1.5)], [], 0.0),
    "e": ([(0, 0.5, 1, 0.5)], [(0.5, 0.5, 0.5, 0, 310)], 1.0),
    "b": ([(0, 0, 0, 1.6)], [(0.5, 0.5, 0.5, 0, 360)], 1.0),
    "r": ([(0, 0, 0, 1)], [(0.45, 0.55, 0.45, 50, 180)], 0.7),
    "d": ([(1, 0, 1, 1.6)], [(0.5, 0.5, 0.5, 0, 360)], 1.0),
    "f": ([(0.3, 0, 0.3, 1.2), (0, 0.95, 0.75, 0.95)], [(0.7, 1.2, 0.4, 60, 180)], 0.85),
}
WORD = "miebrdf"
GAP = 0.6


def line_distance(x, y, line):
    x0, y0, x1, y1 = line
    length2 = (x1 - x0) ** 2 + (y1 - y0) ** 2
    t = 0.0 if length2 == 0 else ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / length2
    t = min(1.0, max(0.0, t))
    return math.hypot(x - x0 - t * (x1 - x0), y - y0 - t * (y1 - y0))


def arc_distance(x, y, arc):
    cx, cy, radius, first, last = arc
    angle = math.degrees(math.atan2(y - cy, x - cx)) % 360
    if first <= angle <= last:
        return abs(math.hypot(x - cx, y - cy) - radius)
    ends = ((cx + radius * math.cos(math.radians(a)), cy + radius * math.sin(math.radians(a)))
            for a in (first, last))
    return min(math.hypot(x - ex, y - ey) for ex, ey in ends)


def is_ink(letter, x, y):
    lines, arcs, _ = LETTERS[letter]
    return (any(line_distance(x, y, line) <= STROKE for line in lines)
            or any(arc_distance(x, y, arc) <= STROKE for arc in arcs))


def draw():
    """Rows of grey levels, from the top."""
    length = sum(LETTERS[c][2] for c in WORD) + GAP * (len(WORD) - 1) + 2 * STROKE
    scale = WIDTH * (1 - 2 * MARGIN) / length
    baseline = 0.5 * HEIGHT + 0.5 * 1.6 * scale
    rows = [bytearray(WIDTH) for _ in range(HEIGHT)]
    pen = STROKE
    for position, letter in enumerate(WORD):
        left = WIDTH * MARGIN + pen * scale
        level = 128 if position < 3 else 255
        for row in range(HEIGHT):
            y = (baseline - row - 0.5) / scale
            if not -0.3 <= y <= 1.9:
                continue
            first = max(0, int(left - 0.3 * scale))
            last = min(WIDTH, int(left + (LETTERS[letter][2] + 0.3) * scale))
            for column in range(first, last):
                if is_ink(letter, (column + 0.5 - left) / scale, y):
                    rows[row][column] = level
        pen += LETTERS[letter][2] + GAP
    return rows


def write_png(path, rows):
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 0, 0, 0, 0)
    pixels = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows), 9)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", pixels)
                   + chunk(b"IEND", b""))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    write_png(sys.argv[1], draw())
