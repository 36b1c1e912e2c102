#!/usr/bin/env python3
"""Looks for words that must not stand in the sources, each with the reason.

usage: words.py              check the repository this script lies in
       words.py --self-test  plant each word and demand that it is found
"""
import re
import sys
from pathlib import Path
from typing import NamedTuple

SOURCES = r"\.(hpp|cpp)$"
EVERYTHING = r""


class Rule(NamedTuple):
    word: str
    why: str
    where: str  # pattern of the paths that it holds for
    example: str


LIBM = "sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|exp|exp2|expm1|log|log2|log10|log1p|pow|hypot|cbrt"
RULES = [
    Rule(r"\b(TODO|FIXME|XXX|HACK)\b", "do it, or open an issue", EVERYTHING, "// " + "TODO later"),
    Rule(r"(?<![\w.}/])/(work|home|root|Users)/\w", "a path of one machine", EVERYTHING, 'open("' + '/home/me/log")'),
    Rule(r"\brandom_device\b", "never the same twice; take a seed", SOURCES, "std::random_device source;"),
    Rule(r"\bstd::\w+_distribution\b", "differs from library to library", SOURCES, "std::normal_distribution<> d;"),
    Rule(r"(?<![\w:])(std::)?s?rand\(", "hidden state, differs from library to library", SOURCES, "x = rand();"),
    Rule(r"\busing namespace std\b", "say std::", SOURCES, "using namespace std;"),
    Rule(r"\bNOLINT(NEXTLINE|BEGIN)?(?!END)\b(?!\([\w.,* -]+\): \S)", "name the check and give the reason: "
         "NOLINT(check): reason", SOURCES, "f();  // NOLINT"),
    Rule(rf"\bstd::({LIBM})f?\(", "the last bit differs from libm to libm; core/base/trig.hpp, or a formula without it",
         r"^core/.*\.(hpp|cpp)$", "std::sin(x)"),
]
DIRECTORIES = ["core", "drivers", "config", "platform", "tools", "tests", "toolchains", ".ci"]
BINARY = {".png", ".pgm", ".xz", ".gz", ".bz2", ".zst", ".bin"}


def violations(path, text):
    rules = [r for r in RULES if re.search(r.where, path)]
    return [f"{path}:{number}: {match[0]}: {rule.why}"
            for number, line in enumerate(text.splitlines(), start=1)
            for rule in rules
            for match in [re.search(rule.word, line)] if match]


def check(root):
    files = [f for d in DIRECTORIES for f in sorted((root / d).rglob("*")) if f.is_file()]
    files += [f for f in sorted(root.iterdir()) if f.suffix in {".txt", ".md", ".json"}]
    found = []
    for file in files:
        path = file.relative_to(root).as_posix()
        # This file spells the words; a fuzz corpus holds arbitrary bytes.
        if file == Path(__file__).resolve() or file.suffix in BINARY or "/corpus/" in path or "__pycache__" in path:
            continue
        found += violations(path, file.read_text(errors="replace"))
    print("\n".join(found + [f"words: {len(files)} files, {len(found)} violations"]))
    return bool(found) or not files


def self_test():
    path = "core/slam/planted.cpp"
    wrong = [f"not found: {r.example}" for r in RULES if not violations(path, r.example)]
    clean = ["f();  // NOLINT(bugprone-x): the standard demands it", "operand(2)", "std::sqrt(2.0)", "sin_cos(x)",
             'root / "home/x"', "${HOME}/" + "work/x"]
    wrong += [f"refused: {v}" for line in clean for v in violations(path, line)]
    wrong += [f"refused: {v}" for v in violations("tools/sim/world.cpp", "std::sin(x)")]
    print("\n".join(wrong + [f"words: {len(RULES)} planted, {len(wrong)} wrong"]))
    return bool(wrong)


if __name__ == "__main__":
    if sys.argv[1:] not in ([], ["--self-test"]):
        sys.exit(__doc__)
    sys.exit(self_test() if sys.argv[1:] else check(Path(__file__).resolve().parents[2]))
