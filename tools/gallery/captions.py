#!/usr/bin/env python3
"""Writes a name under each ball of a hero picture. Needs matplotlib.

Usage: name_balls.py PICTURE.png SPACING NAME ...

SPACING is that of the balls, as a share of the picture's width.
"""
import sys

import matplotlib

matplotlib.use("Agg")
from matplotlib import font_manager, image
from matplotlib import pyplot as plt


def main():
    path, spacing, names = sys.argv[1], float(sys.argv[2]), sys.argv[3:]
    picture = image.imread(path)[:, :, :3]
    height, width = picture.shape[:2]
    figure = plt.figure(figsize=(width / 100, height / 100), dpi=100)
    figure.figimage(picture)
    font = font_manager.FontProperties(family="DejaVu Sans", size=0.0105 * width)
    for place, name in enumerate(names):
        x = 0.5 + spacing * (place - (len(names) - 1) / 2)
        figure.text(x, 0.16, name, ha="center", va="top", color="#e8e8e8", fontproperties=font, linespacing=1.35)
    figure.savefig(path, dpi=100)


if __name__ == "__main__":
    main()
