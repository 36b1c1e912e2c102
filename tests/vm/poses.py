#!/usr/bin/env python3
"""Reads poses that candump -L heard on the bus, by the DBC file, and demands that they make sense.

usage: poses.py DBC CANDUMP_LOG
"""
import math
import re
import sys

SIGNAL = re.compile(r"\s*SG_ (\w+) : (\d+)\|(\d+)@1([+-]) \(([-\d.]+),([-\d.]+)\)")


def read_dbc(path):
    messages, signals = {}, None
    for line in open(path):
        if begin := re.match(r"BO_ (\d+) ", line):
            signals = messages.setdefault(int(begin[1]), {})
        elif signal := SIGNAL.match(line):
            name, low, bits, sign, scale, offset = signal.groups()
            signals[name] = (int(low), int(bits), sign == "-", float(scale), float(offset))
    return messages


def decode(signals, data):
    word = int.from_bytes(data, "little")
    out = {}
    for name, (low, bits, signed, scale, offset) in signals.items():
        raw = word >> low & (1 << bits) - 1
        if signed and raw >> (bits - 1):
            raw -= 1 << bits
        out[name] = raw * scale + offset
    return out


def crc8_j1850(data):
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 0x1D if crc & 0x80 else crc << 1) & 0xFF
    return crc ^ 0xFF


def main():
    messages = read_dbc(sys.argv[1])
    poses, pose, bad_crc = [], {}, 0
    for line in open(sys.argv[2]):
        time, _, frame = line.split()
        identifier, data = frame.split("#")
        identifier, data = int(identifier, 16), bytes.fromhex(data)
        if identifier not in messages:
            continue
        if crc8_j1850(bytes([identifier & 0xFF, identifier >> 8]) + data[:7]) != data[7]:
            bad_crc += 1
            continue
        pose |= decode(messages[identifier], data)
        if identifier == max(messages):
            poses.append({"time": float(time.strip("()"))} | pose)
            pose = {}
    known = [p for p in poses if not p["Lost"] and p["Matched"]]
    # It drives in a circle of 0.625 m around (0, 0.625), its heading along the circle.
    errors = sorted(abs(math.hypot(p["X"], p["Y"] - 0.625) - 0.625) for p in known if p["Speed"] > 0.1)
    along = sorted(abs(math.remainder(math.atan2(p["X"], 0.625 - p["Y"]) - p["Heading"], 2 * math.pi))
                   for p in known if p["Speed"] > 0.1)
    print(f"poses: {len(poses)} on the bus, {len(known)} of them known, {bad_crc} frames with a wrong checksum")
    print(f"poses: from the circle, median {errors[len(errors) // 2]:.3f} m, 95 % {errors[len(errors) * 95 // 100]:.3f} m; "
          f"heading, median {math.degrees(along[len(along) // 2]):.1f} deg, 95 % {math.degrees(along[len(along) * 95 // 100]):.1f} deg")
    assert bad_crc == 5, "five frames of a stranger had a wrong checksum"
    assert len(known) > 500, "too few poses"
    assert errors[len(errors) // 2] < 0.05 and along[len(along) // 2] < math.radians(5), "not where the robot was"


main()
