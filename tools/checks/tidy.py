#!/usr/bin/env python3
"""Runs clang-tidy over sources, but not again over one that has passed as it is.

usage: tidy.py BUILD PATH...        these .cpp, and all below directories; BUILD holds compile_commands.json
       tidy.py --self-test CLANG    plant findings and demand that each is found, also after a file was clean

What is as it was: the file and all it includes with their comments, its compile command, .clang-tidy, and clang-tidy
itself. That it passed is noted in ~/.cache/crspf-tidy (XDG_CACHE_HOME); delete it to begin anew.
"""
import concurrent.futures
import hashlib
import json
import os
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path


def cache():
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "crspf-tidy"


def command_of(entry):
    """The compile command's words, without a compiler cache before it and without its output."""
    words = shlex.split(entry["command"])
    words = words[1:] if Path(words[0]).name == "ccache" else words
    out = words.index("-o")
    return words[:out] + words[out + 2:]


def key_of(entry, shared):
    words = command_of(entry)
    words.remove("-c")
    seen = subprocess.run(words + ["-E", "-CC"], cwd=entry["directory"], capture_output=True)
    if seen.returncode != 0:
        return None  # clang-tidy will say why
    return hashlib.sha256(b"\0".join([shared, " ".join(words).encode(), seen.stdout])).hexdigest()


def check(entry, shared, build):
    """None where it had passed as it is, else clang-tidy's exit status and words."""
    key = key_of(entry, shared)
    passed = cache() / key if key else None
    if passed and passed.exists():
        return None
    ran = subprocess.run(["clang-tidy", "-p", build, "--quiet", entry["file"]], text=True, stdout=subprocess.PIPE,
                         stderr=subprocess.STDOUT)
    if passed and ran.returncode == 0:
        passed.touch()
    return ran.returncode, ran.stdout


def run(root, build, paths):
    entries = {entry["file"]: entry for entry in json.loads((Path(build) / "compile_commands.json").read_text())}
    paths = [(root / p).resolve() for p in paths]
    files = [str(f) for p in paths for f in (sorted(p.rglob("*.cpp")) if p.is_dir() else [p])]
    unknown = [f for f in files if f not in entries]
    if unknown or not files:
        print(f"tidy: not built, so not checked: {' '.join(unknown) or 'nothing is'}")
        return 1
    version = subprocess.run(["clang-tidy", "--version"], capture_output=True, check=True).stdout
    shared = version + (root / ".clang-tidy").read_bytes()
    cache().mkdir(parents=True, exist_ok=True)
    failed = before = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for done, (file, result) in enumerate(
                zip(files, pool.map(lambda f: check(entries[f], shared, build), files)), start=1):
            if result is None:
                before += 1
                continue
            status, words = result
            failed += status != 0
            print(f"{words if status else ''}tidy: {done} of {len(files)}: {file}: {'FAILED' if status else 'clean'}", flush=True)
    print(f"tidy: {len(files)} files, {before} of them passed before as they are, {failed} failed")
    return 1 if failed else 0


def self_test(clang):
    with tempfile.TemporaryDirectory() as directory:
        os.environ["XDG_CACHE_HOME"] = directory
        root = Path(directory) / "tree"
        (root / "code").mkdir(parents=True)
        (root / ".clang-tidy").write_text("Checks: '-*,readability-else-after-return'\nWarningsAsErrors: '*'\n")
        source, header = root / "code/a.cpp", root / "code/a.hpp"
        (root / "compile_commands.json").write_text(json.dumps(
            [{"directory": str(root), "file": str(source), "command": f"{clang} -c {source} -o a.o"}]))
        bad = "int f(int a) { if (a) { return 1; } else { return 2; } }\n"
        wrong = []

        def expect(what, status):
            if run(root, str(root), ["code"]) != status:
                wrong.append(what)

        header.write_text("int f(int);\n")
        source.write_text('#include "a.hpp"\n')
        expect("a clean file", 0)
        expect("the same again", 0)
        source.write_text('#include "a.hpp"\n' + bad)
        expect("a finding in a file that was clean", 1)
        expect("the same again", 1)
        source.write_text('#include "a.hpp"\n' + bad.replace("else", "else  /* NOLINT */"))
        expect("a comment that silences it", 0)
        source.write_text('#include "a.hpp"\n#ifdef BAD\n' + bad + "#endif\n")
        expect("a finding that is left out", 0)
        header.write_text("#define BAD\n")
        expect("a header that lets it in", 1)
        print(f"tidy: self-test: {', '.join(wrong) or 'all as expected'}")
        return bool(wrong)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--self-test"] and len(sys.argv) == 3:
        sys.exit(self_test(sys.argv[2]))
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(run(Path(__file__).resolve().parents[2], sys.argv[1], sys.argv[2:]))
