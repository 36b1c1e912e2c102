#!/usr/bin/env python3
"""Holds every #include line against the layer table of CONTRIBUTING.md.

usage: layers.py              check the repository this script lies in
       layers.py --self-test  plant violations and demand that each is found
"""
import re
import sys
from pathlib import Path, PurePosixPath
from typing import NamedTuple

ANY = None

# Headers without a heap, a clock, a thread, a stream or an opinion about the last bit of a number.
PURE_STD = set("""
    algorithm array atomic bit climits compare concepts cstddef cstdint cstring initializer_list iterator limits new
    numbers numeric optional ranges span string_view tuple type_traits utility version
    """.split())
# Text that is read at the start: views of the caller's bytes, and numbers correctly rounded, without a locale.
TEXT_STD = {"charconv", "system_error"}

# <cmath> is allowed to the core only with a comment that names what is used, and only for what IEEE 754 defines to the
# bit: `#include <cmath>  // sqrt, floor`.
EXACT_MATH = set("abs ceil copysign fabs floor isfinite isinf isnan llround lround lrint nearbyint rint round signbit sqrt "
                 "trunc".split())


# Instructions of one processor: what the file's name holds, and the header's.
INTRINSICS = {"avx2": "intrin.h", "neon": "arm_neon.h"}


class Layer(NamedTuple):
    may: list  # path prefixes, or patterns, inside the repository
    system: set | None  # names within <>, ANY for all


CORE = ["core/base/", "config/capacities.hpp"]
EIGEN = {"Eigen/Core", "Eigen/Dense", "Eigen/Geometry", "Eigen/Cholesky", "Eigen/Eigenvalues", "Eigen/LU"}

# The longest prefix of a file's path gives its layer. A file in no layer is an error: add a row here and in
# CONTRIBUTING.md.
TABLE = {
    "config/capacities.hpp": Layer(may=[], system={"cstddef", "cstdint"}),
    "core/base/": Layer(may=CORE, system=PURE_STD),
    "core/odometry/": Layer(may=CORE + ["core/odometry/"], system=PURE_STD | EIGEN),
    "core/slam/": Layer(may=CORE + ["core/odometry/", "core/slam/"], system=PURE_STD | EIGEN),
    "drivers/common/": Layer(may=CORE + ["drivers/common/"], system=PURE_STD),
    "drivers/scip/": Layer(may=CORE + ["drivers/common/", "drivers/scip/"], system=PURE_STD),
    "drivers/velodyne/": Layer(may=CORE + ["drivers/common/", "drivers/velodyne/"], system=PURE_STD),
    "drivers/sick/": Layer(may=CORE + ["drivers/common/", "drivers/sick/"], system=PURE_STD),
    "drivers/ldrobot/": Layer(may=CORE + ["drivers/common/", "drivers/ldrobot/"], system=PURE_STD),
    "drivers/can/": Layer(may=CORE + ["drivers/common/", "drivers/can/"], system=PURE_STD),
    "drivers/can/dbc_": Layer(may=CORE + ["drivers/common/", "drivers/can/"], system=PURE_STD | TEXT_STD),
    "drivers/stereo/": Layer(may=CORE + ["drivers/common/", "drivers/stereo/"],
                             system=PURE_STD | EIGEN | {"memory", "vector", "opencv2/core.hpp", "opencv2/imgproc.hpp",
                                                        "opencv2/calib3d.hpp", "opencv2/video/tracking.hpp"}),
    "drivers/motion/": Layer(may=CORE + ["drivers/common/", "drivers/motion/"], system=PURE_STD),
    "config/": Layer(may=["config/", "core/base/", "core/*/*_params.hpp", "drivers/*/*_params.hpp", "drivers/can/",
                          "drivers/sick/lms2xx_codec.hpp", "platform/files/"], system=ANY),
    "platform/ports/": Layer(may=CORE + ["platform/ports/"], system=PURE_STD),
    "platform/linux/": Layer(may=CORE + ["platform/ports/", "platform/files/", "platform/linux/"], system=ANY),
    "platform/files/": Layer(may=CORE + ["platform/files/"], system=ANY),
    "platform/capture/": Layer(may=CORE + ["platform/files/", "platform/ports/", "platform/capture/"], system=ANY),
    "platform/service/": Layer(may=["core/", "drivers/", "config/", "platform/files/", "platform/linux/",
                                    "platform/ports/", "platform/capture/", "platform/service/"], system=ANY),
    "platform/crspfd/": Layer(may=["core/", "drivers/", "config/", "platform/"], system=ANY),
    "tools/": Layer(may=["core/", "drivers/", "config/", "platform/", "tools/"], system=ANY),
    "tests/": Layer(may=["core/", "drivers/", "config/", "platform/", "tools/", "tests/"], system=ANY),
}

SOURCE_SUFFIXES = {".hpp", ".cpp", ".h", ".inl"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(?P<open>[<"])(?P<name>[^>"]*)[>"]\s*(//\s*(?P<comment>.*))?')


def layer_of(path):
    rows = [prefix for prefix in TABLE if path.startswith(prefix)]
    return TABLE[max(rows, key=len)] if rows else None


def matches(path, pattern):
    return path.startswith(pattern) or PurePosixPath(path).match(pattern)


def why_not(path, layer, include, exists):
    """The reason why `path` must not hold this include line, or None."""
    name = include["name"]
    if include["open"] == '"':
        if not exists(name):
            return f'"{name}" is not a file seen from the repository root; write the path from there, or <> for a library'
        if not any(matches(name, pattern) for pattern in layer.may):
            return f"this layer may not include {name}"
        return None
    if exists(name):
        return f'<{name}> is our own file: write "{name}"'
    for processor, header in INTRINSICS.items():
        if name.endswith(header):
            if processor not in PurePosixPath(path).name:
                return f"<{name}> belongs in a file named *{processor}*, beside the portable kernel"
            return None
    if layer.system is ANY or name in layer.system:
        return None
    if name == "cmath":
        named = set(re.split(r"[,\s]+", (include["comment"] or "").strip())) - {""}
        if named and named <= EXACT_MATH:
            return None
        return "<cmath> needs a comment that names what is used, all of it exact, as in `#include <cmath>  // sqrt, floor`"
    return f"this layer may not include <{name}>"


def violations(path, text, exists):
    layer = layer_of(path)
    if layer is None:
        return [f"{path}:1: in no layer; give its directory a row in tools/checks/layers.py and CONTRIBUTING.md"]
    found = []
    for number, line in enumerate(text.splitlines(), start=1):
        include = INCLUDE.match(line)
        reason = why_not(path, layer, include, exists) if include else None
        if reason:
            found.append(f"{path}:{number}: {reason}")
    return found


def check(root):
    directories = [d for d in sorted(root.iterdir()) if d.is_dir() and not d.name.startswith((".", "build", "out"))]
    files = [f for d in directories for f in sorted(d.rglob("*")) if f.suffix in SOURCE_SUFFIXES]
    paths = [f.relative_to(root).as_posix() for f in files]
    found = [v for p in paths for v in violations(p, (root / p).read_text(), lambda name: (root / name).is_file())]
    print("\n".join(found + [f"layers: {len(paths)} files, {len(found)} violations"]))
    return bool(found) or not paths


def self_test():
    ours = {"core/base/pose.hpp", "core/slam/filter.hpp", "core/slam/slam_params.hpp", "core/odometry/fuse.hpp",
            "config/capacities.hpp", "config/loader.hpp", "platform/files/input_error.hpp", "platform/files/png.hpp",
            "platform/capture/log_reader.hpp", "tools/sim/world.hpp", "tests/support/heap_guard.hpp"}
    forbidden = [
        ("core/base/a.hpp", "#include <vector>"),
        ("core/base/a.hpp", "#include <Eigen/Core>"),
        ("core/base/a.hpp", "#include <cmath>"),
        ("core/base/a.hpp", "#include <cmath>  // sqrt, sin"),
        ("core/base/a.hpp", '#include "core/slam/filter.hpp"'),
        ("core/odometry/a.cpp", '#include "core/slam/filter.hpp"'),
        ("core/slam/a.cpp", "  #  include <chrono>"),
        ("core/slam/a.cpp", "#include <immintrin.h>"),
        ("core/slam/kernel_avx2.cpp", "#include <arm_neon.h>"),
        ("core/slam/a.cpp", "#include <sys/mman.h>"),
        ("core/slam/a.cpp", '#include "platform/files/png.hpp"'),
        ("core/slam/a.cpp", '#include "config/loader.hpp"'),
        ("core/slam/a.cpp", '#include "filter.hpp"'),
        ("core/slam/a.cpp", "#include <core/slam/filter.hpp>"),
        ("config/capacities.hpp", '#include "core/base/pose.hpp"'),
        ("config/loader.cpp", '#include "core/slam/filter.hpp"'),
        ("config/loader.cpp", '#include "core/odometry/fuse.hpp"'),
        ("config/loader.cpp", '#include "platform/capture/log_reader.hpp"'),
        ("platform/files/a.cpp", '#include "platform/capture/log_reader.hpp"'),
        ("platform/capture/a.cpp", '#include "core/slam/slam_params.hpp"'),
        ("platform/capture/a.cpp", '#include "config/loader.hpp"'),
        ("tools/crspf/a.cpp", '#include "tests/support/heap_guard.hpp"'),
        ("drivers/a.cpp", "#include <vector>"),
    ]
    allowed = [
        ("core/base/a.hpp", "#include <cstdint>"),
        ("core/base/a.hpp", "#include <cmath>  // sqrt, floor"),
        ("core/base/a.hpp", '#include "config/capacities.hpp"'),
        ("core/base/a.hpp", "// #include <vector>"),
        ("core/slam/a.cpp", "#include <Eigen/Core>"),
        ("core/slam/a.cpp", '#include "core/odometry/fuse.hpp"'),
        ("core/slam/kernel_avx2.cpp", "#include <immintrin.h>"),
        ("core/slam/kernel_neon.cpp", "#include <arm_neon.h>"),
        ("config/loader.cpp", '#include "core/slam/slam_params.hpp"'),
        ("config/loader.cpp", '#include "platform/files/input_error.hpp"'),
        ("config/loader.cpp", "#include <toml++/toml.h>"),
        ("platform/capture/a.cpp", '#include "platform/files/input_error.hpp"'),
        ("tools/crspf/a.cpp", '#include "core/slam/filter.hpp"'),
        ("tests/unit/a.cpp", '#include "tools/sim/world.hpp"'),
    ]
    wrong = [f"not found:  {p}: {line}" for p, line in forbidden if not violations(p, line, ours.__contains__)]
    wrong += [f"refused:    {v}" for p, line in allowed for v in violations(p, line, ours.__contains__)]
    print("\n".join(wrong + [f"layers: {len(forbidden)} planted, {len(allowed)} allowed, {len(wrong)} wrong"]))
    return bool(wrong)


if __name__ == "__main__":
    if sys.argv[1:] not in ([], ["--self-test"]):
        sys.exit(__doc__)
    sys.exit(self_test() if sys.argv[1:] else check(Path(__file__).resolve().parents[2]))
