#!/usr/bin/env python3
"""What each part of the method adds: the same runs with one part switched off at a time. Prints a Markdown table.

usage: tools/ablation.py [--seeds N] [--data DIR] [--crspf PROGRAM]

Runs intel.clf.xz and aces.clf.xz of DIR/carmen where they are present, and a simulated 80 m corridor (5 m lidar range,
1.5 m/s, 45 deg/s, odometry 2 % too long). intel: mean absolute translation error over intel.relations, mean and worst
seed; every fifth scan only: the same, over the relations whose scans were kept. aces has no ground truth: the match
value M that 1 % of the scans fall below, low where walls are doubled. Corridor: error at its far end, 79 m from the
start, and back at the start.
"""
import argparse
import json
import lzma
import math
import pathlib
import subprocess
import tempfile

VARIANTS = [
    ("as shipped", {}),
    ("without critical rays", {"critical_rays": {"enabled": "false"}}),
    ("critical rays weigh 10", {"critical_rays": {"weight": "10.0"}}),
    ("without feedback", {"particle_filter": {"feedback": "false"}}),
    ("without error removal", {"map": {"remove_errors": "false"}}),
    ("without refinement", {"particle_filter": {"refinement": "false"}}),
    ("without degeneracy rule", {"particle_filter": {"degeneracy": "false"}}),
    ("without the pull to odometry", {"particle_filter": {"pull_weight": "0.0"}}),
    ("without thin walls", {"map": {"behind_cells": "0"}}),
]


def write_config(path, base, changes, seed):
    tables = {name: dict(keys) for name, keys in base.items()}
    for name, keys in changes.items():
        tables.setdefault(name, {}).update(keys)
    tables.setdefault("particle_filter", {})["seed"] = str(seed)
    text = "".join(f"[{name}]\n" + "".join(f"{k} = {v}\n" for k, v in keys.items()) for name, keys in tables.items())
    path.write_text(text)


def read_tables(path):
    """The simulator's config.toml: tables of plain numbers."""
    tables, table = {}, None
    for line in path.read_text().splitlines():
        line = line.split("#")[0].strip()
        if line.startswith("["):
            table = tables.setdefault(line.strip("[]"), {})
        elif "=" in line:
            key, value = (part.strip() for part in line.split("=", 1))
            table[key] = value
    return tables


def poses(path):
    rows = (line.split() for line in path.read_text().splitlines() if not line.startswith("#"))
    return [(float(r[0]), float(r[1]), float(r[2]), 2 * math.atan2(float(r[6]), float(r[7]))) for r in rows]


def from_first(track):
    _, x0, y0, t0 = track[0]
    c, s = math.cos(t0), math.sin(t0)
    return [(c * (x - x0) + s * (y - y0), c * (y - y0) - s * (x - x0)) for _, x, y, _ in track]


class Runner:
    def __init__(self, program, work):
        self.program, self.work = program, work

    def command(self, *arguments):
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(done.stderr)
        return done.stdout

    def replay(self, log, base, changes, seed):
        config, out = self.work / "config.toml", self.work / "out"
        write_config(config, base, changes, seed)
        self.command("replay", log, "--config", config, "--out", out)
        return out


def relation_error(run, out, relations):
    return json.loads(run.command("eval", "relations", out / "trajectory.tum", relations, "--json"))["translation_m"]["mean"]


def kept_relations(relations, log, path):
    """The relations both of whose stamps are a scan of the log, to half a millisecond."""
    stamps = sorted(float(line.split()[-3]) for line in log.read_text().splitlines() if line.startswith("FLASER"))
    import bisect

    def near(t):
        i = bisect.bisect_left(stamps, t)
        return min(abs(t - s) for s in stamps[max(0, i - 1):i + 1]) < 0.0005

    with lzma.open(relations, "rt") as file:
        rows = [line for line in file if not line.startswith("#")]
    path.write_text("".join(r for r in rows if near(float(r.split()[0])) and near(float(r.split()[1]))))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--data", type=pathlib.Path, default=pathlib.Path("../shared/data"))
    parser.add_argument("--crspf", default="build/release/tools/crspf/crspf")
    options = parser.parse_args()
    seeds = range(1, options.seeds + 1)
    intel = options.data / "carmen/intel.clf.xz"
    relations = options.data / "carmen/intel.relations.xz"
    aces = options.data / "carmen/aces.clf.xz"
    with tempfile.TemporaryDirectory() as directory:
        work = pathlib.Path(directory)
        run = Runner(options.crspf, work)
        if intel.exists():
            with lzma.open(intel, "rt") as file:
                scans = [line for line in file if line.startswith("FLASER")]
            (work / "fifth.clf").write_text("".join(scans[::5]))
            kept_relations(relations, work / "fifth.clf", work / "fifth.relations")
        for seed in seeds:
            run.command("sim", "--world", "corridor", "--lidar", "urg", "--max-range", 5, "--speed", 1.5, "--turn-rate",
                        45, "--odom-scale-error", 0.02, "--seed", seed, "--out", work / f"corridor{seed}")
        print("| variant | intel [m] | every 5th scan [m] | aces, M of the lowest 1 % | corridor, far end [m] | corridor, end [m] |")
        print("|---|---|---|---|---|---|")
        for name, changes in VARIANTS:
            cells = [name]
            if intel.exists():
                errors = [relation_error(run, run.replay(intel, {}, changes, s), relations) for s in seeds]
                cells.append(f"{sum(errors) / len(errors):.4f}, worst {max(errors):.4f}")
                errors = [relation_error(run, run.replay(work / "fifth.clf", {}, changes, s), work / "fifth.relations")
                          for s in seeds]
                cells.append(f"{sum(errors) / len(errors):.4f}, worst {max(errors):.4f}")
            else:
                cells += ["no data", "no data"]
            if aces.exists():
                m = [json.loads((run.replay(aces, {}, changes, s) / "report.json").read_text())["match_value_M"]["p01"]
                     for s in seeds]
                cells.append(f"{sum(m) / len(m):.0f}")
            else:
                cells.append("no data")
            far, end = [], []
            for s in seeds:
                source = work / f"corridor{s}"
                out = run.replay(source / "log.clf", read_tables(source / "config.toml"), changes, s)
                found, truth = from_first(poses(out / "trajectory.tum")), from_first(poses(source / "truth.tum"))
                error = [math.dist(a, b) for a, b in zip(found, truth)]
                far.append(error[max(range(len(truth)), key=lambda i: math.hypot(*truth[i]))])
                end.append(error[-1])
            cells += [f"{sum(far) / len(far):.2f}, worst {max(far):.2f}", f"{sum(end) / len(end):.3f}, worst {max(end):.3f}"]
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
