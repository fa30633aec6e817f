#!/usr/bin/env python3
"""Writes the set of the hero pictures: balls in a row on a wide round floor, as an OBJ file, and a mask whose grey columns say which material lies where (`miebrdf render --mask
MASK.png --mask-projection uv`). Material 1 is the floor, 2, 3, ... the balls from left to right.
Only Python's standard library is needed.

Usage: make_set.py BALLS SET.obj MASK.png
"""
import math
import struct
import sys
import zlib

RINGS, SEGMENTS = 96, 192
SPACING = 2.35  # between centres, in radii
FLOOR = 60.0  # its radius


def ball(centre, u):
    """Vertices (position, normal, u) and quads of a ball of radius 1 that stands on the floor."""
    vertices, faces = [], []
    for i in range(RINGS + 1):
        theta = math.pi * i / RINGS
        for j in range(SEGMENTS):
            phi = 2 * math.pi * j / SEGMENTS
            normal = (math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi))
            vertices.append(((centre + normal[0], 1 + normal[1], normal[2]), normal, u))
    for i in range(RINGS):
        for j in range(SEGMENTS):
            a, b = i * SEGMENTS + j, i * SEGMENTS + (j + 1) % SEGMENTS
            faces.append((a, b, b + SEGMENTS, a + SEGMENTS))
    return vertices, faces


def floor(u):
    """A fan of triangles around the middle."""
    up = (0.0, 1.0, 0.0)
    vertices = [((0.0, 0.0, 0.0), up, u)]
    for j in range(SEGMENTS):
        phi = 2 * math.pi * j / SEGMENTS
        vertices.append(((FLOOR * math.cos(phi), 0.0, FLOOR * math.sin(phi)), up, u))
    return vertices, [(0, 1 + (j + 1) % SEGMENTS, 1 + j) for j in range(SEGMENTS)]


def write_obj(path, balls):
    materials = balls + 1
    parts = [floor(0.5 / materials)]
    for k in range(balls):
        parts.append(ball(SPACING * (k - (balls - 1) / 2), (k + 1.5) / materials))
    with open(path, "w") as obj:
        first = 1
        for vertices, faces in parts:
            for position, normal, u in vertices:
                (x, y, z), (nx, ny, nz) = position, normal
                obj.write(f"v {x:.6f} {y:.6f} {z:.6f}\nvt {u:.6f} 0.5\nvn {nx:.6f} {ny:.6f} {nz:.6f}\n")
            for face in faces:
                obj.write("f " + " ".join(f"{first + v}/{first + v}/{first + v}" for v in face) + "\n")
            first += len(vertices)


def write_mask(path, materials):
    """One pixel for each material, grey levels in equal steps."""
    levels = bytes(round(255 * (k + 0.5) / materials) for k in range(materials))

    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    with open(path, "wb") as png:
        png.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", materials, 1, 8, 0, 0, 0, 0)) +
                  chunk(b"IDAT", zlib.compress(b"\0" + levels)) + chunk(b"IEND", b""))


if __name__ == "__main__":
    if len(sys.argv) != 4 or not sys.argv[1].isdigit() or int(sys.argv[1]) < 1:
        sys.exit(__doc__)
    write_obj(sys.argv[2], int(sys.argv[1]))
    write_mask(sys.argv[3], int(sys.argv[1]) + 1)
