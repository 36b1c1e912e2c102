#!/usr/bin/env python3
"""Demands that all of a build compiles Eigen alike.

usage: eigen_alike.py BUILD    BUILD holds compile_commands.json
       eigen_alike.py --self-test

Of an inline function that was inlined nowhere the linker takes any translation unit's. Were Eigen's vector code on in
one and off in another, the last bit of a pose would depend on the optimisation level.
"""
import json
import sys
from pathlib import Path

WANTED = "-DEIGEN_DONT_VECTORIZE"


def unlike(entries):
    return [e["file"] for e in entries if "/eigen3" in e["command"] and WANTED not in e["command"].split()]


def self_test():
    on, off = "c++ -isystem /usr/include/eigen3 -c a.cpp", f"c++ {WANTED} -isystem /usr/include/eigen3 -c b.cpp"
    found = unlike([{"file": "a", "command": on}, {"file": "b", "command": off}, {"file": "c", "command": "c++ -c c.cpp"}])
    print(f"eigen_alike: self-test: {'all as expected' if found == ['a'] else found}")
    return found != ["a"]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    if sys.argv[1] == "--self-test":
        return self_test()
    entries = json.loads((Path(sys.argv[1]) / "compile_commands.json").read_text())
    files = unlike(entries)
    print(f"eigen_alike: {len(entries)} commands, {len(files)} unlike {' '.join(files)}")
    return bool(files)


if __name__ == "__main__":
    sys.exit(main())
