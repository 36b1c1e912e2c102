#!/usr/bin/env python3
"""Pictures of a chessboard by a stereo camera, for the commands of docs/stereo.md. Nothing but a pinhole model.

usage: chessboard.py FOLDER    left00.png, right00.png ...: 9x6 inner corners, squares of 25 mm, cameras 12 cm apart
"""
import math
import struct
import sys
import zlib
from pathlib import Path

WIDTH, HEIGHT, FOCAL_PX, BASELINE_M = 480, 360, 400.0, 0.12
COLUMNS, ROWS, SQUARE_M = 10, 7, 0.025
PLACES = [(x_m, y_m, z_m, math.radians(about_x), math.radians(about_y))
          for x_m, y_m, z_m in ((0.06, 0.0, 0.45), (0.0, -0.08, 0.55), (0.12, 0.09, 0.6))
          for about_x, about_y in ((25, 0), (-25, 0), (0, 25), (0, -25), (15, 20))]


def png(rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">2I5B", WIDTH, HEIGHT, 8, 0, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
            chunk(b"IDAT", zlib.compress(b"".join(b"\0" + bytes(row) for row in rows), 1)) + chunk(b"IEND", b""))


def grey(x, y):
    """Of a point of the board, in squares from its corner; edges as wide as a picture's blur."""
    if not (-1 < x < COLUMNS + 1 and -1 < y < ROWS + 1):
        return 90
    if not (0 < x < COLUMNS and 0 < y < ROWS):
        return 230
    return round(130 - 100 * max(-1.0, min(1.0, 6.0 * math.sin(math.pi * x) * math.sin(math.pi * y))))


def picture(place, camera_x_m):
    x_m, y_m, z_m, a, b = place
    x_m -= camera_x_m
    # The board's axes as the camera sees them: about x, then about y.
    right = (math.cos(b), 0.0, -math.sin(b))
    down = (math.sin(a) * math.sin(b), math.cos(a), math.sin(a) * math.cos(b))
    ahead = (math.cos(a) * math.sin(b), -math.sin(a), math.cos(a) * math.cos(b))
    distance = ahead[0] * x_m + ahead[1] * y_m + ahead[2] * z_m
    for row in range(HEIGHT):
        v = (row - HEIGHT / 2 + 0.5) / FOCAL_PX
        line = bytearray()
        for column in range(WIDTH):
            u = (column - WIDTH / 2 + 0.5) / FOCAL_PX
            s = distance / (ahead[0] * u + ahead[1] * v + ahead[2])
            dx, dy, dz = s * u - x_m, s * v - y_m, s - z_m
            line.append(grey((right[0] * dx + right[1] * dy + right[2] * dz) / SQUARE_M + COLUMNS / 2,
                             (down[0] * dx + down[1] * dy + down[2] * dz) / SQUARE_M + ROWS / 2))
        yield line


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for number, place in enumerate(PLACES):
        for side, camera_x_m in (("left", 0.0), ("right", BASELINE_M)):
            (Path(sys.argv[1]) / f"{side}{number:02}.png").write_bytes(png(picture(place, camera_x_m)))
