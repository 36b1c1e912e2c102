#!/usr/bin/env python3
"""The fenced blocks of the documents. See docs.py.

usage: docs_blocks.py FOLDER    the blocks that the virtual machine runs (tests/vm/ring.sh): FOLDER/PHASE/DOCUMENT-LINE.sh
"""
import re
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
MACHINE = r"run in the virtual machine: (\w+)"


class Block(NamedTuple):
    line: int
    language: str
    comment: str
    text: str


def blocks(text):
    """The fenced blocks, each with the comment in the last line above it that is not empty."""
    found, fence, above, content = [], None, "", []
    for number, line in enumerate(text.splitlines(), start=1):
        if line.startswith("```"):
            if fence is None:
                comment = re.fullmatch(r"<!-- (.*) -->", above)
                fence, content = (number, line[3:].strip(), comment[1] if comment else ""), []
            else:
                found.append(Block(*fence, "\n".join(content) + "\n"))
                fence, above = None, ""
        elif fence is not None:
            content.append(line)
        elif line.strip():
            above = line.strip()
    return found


def documents():
    return [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for document in documents():
        for block in blocks(document.read_text()):
            if phase := re.fullmatch(MACHINE, block.comment):
                folder = Path(sys.argv[1]) / phase[1]
                folder.mkdir(parents=True, exist_ok=True)
                (folder / f"{document.stem}-{block.line:03}.sh").write_text(block.text)
