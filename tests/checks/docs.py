#!/usr/bin/env python3
"""The commands of the documents: each is run here, or it is said why not, and its words are held against what the
programs and this repository know.

The language of a fenced block tells what it is. `sh` is commands, and the comment above says what becomes of them:
    <!-- run -->              they are run, in a folder of the document's own, after the blocks before
    <!-- run live -->         the same where the configuration is a driving robot's, and nothing has been recorded yet
    <!-- run long -->         with --long they are run, which takes minutes; <!-- run long: recordings --> where $CRSPF_DATA is
    <!-- run in the virtual machine: PHASE -->  tests/vm/ring.sh runs them, at that point of documents.sh
    <!-- not run: REASON -->  why nothing does
Of all of them sub-commands, options, choices, and the files they name are looked at.
`toml` is a configuration, which has to be good; <!-- file: NAME --> above leaves it there for the blocks that follow.
`text`, `json`, `python` and the like are none of this. Commands of crspf and crspfd in the running text are looked at.
In tables of troubleshooting.md the column `message` quotes what the programs say: it has to stand in their sources.

usage: docs.py [--long] CRSPF CRSPFD LIVE_ROBOT [DOCUMENT...]
       docs.py --self-test CRSPF CRSPFD LIVE_ROBOT    plant each kind of fault and demand that it is found
"""
import functools
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True  # of these two: the tree stays as it is
from docs_blocks import MACHINE, blocks, documents  # noqa: E402
from docs_sandbox import Sandbox  # noqa: E402
from docs_words import ROOT, faults_of_command, simple_commands  # noqa: E402

OTHER_LANGUAGES = {"text", "json", "python", "yaml", "ini", "c++", "cmake", "dbc"}


def spans(text):
    """Commands in the running text: (line, command)."""
    inside = False
    for number, line in enumerate(text.splitlines(), start=1):
        inside ^= line.startswith("```")
        if not inside:
            yield from ((number, span) for span in re.findall(r"`(crspfd? [^`]+)`", line))


def messages(text):
    """What the column `message` of a table quotes: (line, message)."""
    column = None
    for number, line in enumerate(text.splitlines(), start=1):
        cells = [c.strip() for c in re.split(r"(?<!\\)\|", line)[1:-1]]
        if not cells:
            column = None
        elif "message" in cells:
            column = cells.index("message")
        elif column is not None and column < len(cells):
            yield from ((number, m.replace("\\|", "|")) for m in re.findall(r"`([^`]+)`", cells[column]))


@functools.cache
def sources():
    """Each source file as its literals read when adjacent ones are put together."""
    files = [f for d in ("core", "drivers", "config", "platform", "tools") for f in (ROOT / d).rglob("*")
             if f.suffix in {".cpp", ".hpp", ".js", ".html"}]
    return [re.sub(r'"\s*\n\s*"', "", f.read_text()).replace('\\"', '"') for f in files]


def stands_in_sources(message):
    """What varies is written as an ellipsis; what is around it has to stand in one file."""
    parts = [part.strip() for part in message.split("…") if part.strip()]
    return bool(parts) and any(all(part in text for part in parts) for text in sources())


class Tally:
    def __init__(self):
        self.run = self.machine = self.looked_at = self.configurations = self.in_text = self.messages = 0
        self.faults = []

    def fault(self, name, line, *said):
        self.faults += [f"{name}:{line}: {fault}" for fault in said]


@functools.cache
def phases():
    """Those of the virtual machine."""
    return set(re.findall(r"^[^#\n]*\bdocuments[ /](\w+)", (ROOT / "tests/vm/documents.sh").read_text(), re.M))


def check_commands(name, block, programs, sandbox, tally):
    for words in simple_commands(block.text):
        tally.fault(name, block.line, *faults_of_command(words, programs))
    syntax = subprocess.run(["bash", "-n"], input=block.text, capture_output=True, text=True)
    machine = re.fullmatch(MACHINE, block.comment)
    if syntax.returncode != 0:
        tally.fault(name, block.line, syntax.stderr.strip())
    elif block.comment in sandbox.runs:
        live = block.comment == "run live"
        said = sandbox.run(block.text, sandbox.folder(folder_name(name) + (".live" if live else ""), live), live)
        if said:
            tally.fault(name, block.line, said)
        tally.run += 1
    elif machine and machine[1] in phases():
        tally.machine += 1
    elif machine:
        tally.fault(name, block.line, f"{machine[1]}: no phase of tests/vm/documents.sh")
    elif re.fullmatch(r"not run: \S.*|run long(: recordings)?", block.comment):
        tally.looked_at += 1
    else:
        tally.fault(name, block.line, "commands without a comment above them that says what becomes of them: see docs.py")


def check_configuration(name, block, sandbox, tally):
    tally.configurations += 1
    folder = sandbox.folder(folder_name(name))
    place = block.comment.removeprefix("file: ") if block.comment.startswith("file: ") else "part.toml"
    file = folder / sandbox.here(place)
    file.write_text(sandbox.here(block.text))
    said = sandbox.run(f"crspf config --check {shlex.quote(str(file))}", folder)
    if said:
        tally.fault(name, block.line, said)


def folder_name(name):
    return name.replace("/", "_")


def check(name, text, programs, sandbox, tally):
    for block in blocks(text):
        if block.language == "sh":
            check_commands(name, block, programs, sandbox, tally)
        elif block.language == "toml":
            check_configuration(name, block, sandbox, tally)
        elif block.language not in OTHER_LANGUAGES:
            tally.fault(name, block.line, f"a block of `{block.language}`: say what it is, as sh or text")
    for line, span in spans(text):
        tally.in_text += 1
        for words in simple_commands(re.sub(r"\\?\|", r"\\|", span)):
            tally.fault(name, line, *faults_of_command(words, programs, in_text=True))
    if "troubleshooting" in name:
        for line, message in messages(text):
            tally.messages += 1
            if not stands_in_sources(message):
                tally.fault(name, line, f"no program says `{message}`")
    sandbox.stop_service()


def check_documents(programs, live_robot, chosen, long):
    tally, sandbox = Tally(), Sandbox(programs["crspf"], programs["crspfd"], live_robot, long)
    files = [Path(f).resolve() for f in chosen] or documents()
    try:
        sandbox.begin()
        for file in files:
            begin = time.monotonic()
            check(str(file.relative_to(ROOT)), file.read_text(), programs, sandbox, tally)
            print(f"{file.relative_to(ROOT)}: {time.monotonic() - begin:.1f} s", flush=True)
    finally:
        sandbox.end()
    print("\n".join(tally.faults))
    if long and "run long: recordings" not in sandbox.runs:
        print("skipped: commands that want recordings; there are none in $CRSPF_DATA")
    print(f"docs: {len(files)} documents: {tally.run} blocks run, {tally.machine} left to the virtual machine, "
          f"{tally.looked_at} looked at, {tally.configurations} configurations, {tally.in_text} commands in the text, "
          f"{tally.messages} messages; {len(tally.faults)} faults")
    return bool(tally.faults) or not tally.run


def sh(text, comment="not run: planted"):
    return f"<!-- {comment} -->\n\n```sh\n{text}\n```\n"


PLANTED = {  # by what is to be said of it
    "says what becomes of them": "words\n\n```sh\ncrspf bench\n```\n",
    "a comment above them": sh("crspf bench", "not run:"),
    "nowhere: no phase of": sh("crspf bench", "run in the virtual machine: nowhere"),
    "tell: no phase of": sh("crspf bench", "run in the virtual machine: tell"),  # a word of its comment
    "say what it is": "```\ncrspf bench\n```\n",
    "replay --uot: no such option": sh("crspf replay run.pcapng --uot out"),
    "doctor --confog: no such option": sh("sudo systemd-run --pipe -p LimitRTPRIO=95 crspf doctor --confog x"),
    "eval ate --wrong: no such option": sh("crspf replay run.pcapng && crspf eval ate --wrong a b"),
    "ctl stattus: no such sub-command": sh("crspf ctl stattus"),
    "--robot tank: none of": sh("crspf sim --robot tank"),
    "--out: without its value": sh("crspf replay run.pcapng --out"),
    "sim office: no such sub-command or word": sh("crspf sim office"),
    "no_such.toml: not in this repository": sh("cp /usr/share/crspf/examples/no_such.toml ."),
    "tools/no_such.sh: not in this repository": sh("tools/no_such.sh"),
    "crspfdd: no unit": sh("systemctl start crspfdd"),
    "realese: no preset": sh("cmake --preset realese"),
    "aptt: a program that": sh("aptt install x"),
    "syntax error": sh("if true; then"),
    "exit status": sh("crspf inspect no_such.pcapng", "run"),
    "no_such.pcapng: cannot be read": sh("crspf inspect no_such.pcapng | cat\ntrue", "run"),
    "unknown key": "```toml\n[lidar]\nx = 1\n```\n",
    "replay --no-such: no such option": "Take `crspf replay --no-such`.\n",
    "ctl status|poze: no such sub-command": "Take `crspf ctl status\\|poze`.\n",
}
GOOD = (sh("printf 'a\\n' > a.txt && crspf inspect run.pcapng --json > out.json; cat /etc/crspf/crspfd.toml", "run") +
        sh("crspf sim --config x.toml --blind 20:22 --start 1,2 # a comment, --no-such\n"
           "crspf ctl set-pose 1.5 -3.0 90") +
        "```toml\n[lidar]\nx_m = 1.0\n```\n\n```text\nanything --at-all\n```\n"
        "`crspf ctl status\\|pose`, `crspf replay RUN...`\n")


def self_test(programs, live_robot):
    """No robot is wanted here."""
    def faults_of(name, text):
        tally, sandbox = Tally(), Sandbox(programs["crspf"], programs["crspfd"], live_robot)
        try:
            for file in ("drive.pcapng", "log.clf.xz", "robot.toml"):
                (sandbox.root / file).touch()
            subprocess.run([programs["crspf"], "sim", "--duration", "2", "--capture", "drive.pcapng", "--out", "sim"],
                           cwd=sandbox.root, check=True, capture_output=True)
            check(name, text, programs, sandbox, tally)
        finally:
            sandbox.end()
        return tally.faults

    planted = {said: ("planted.md", text) for said, text in PLANTED.items()}
    readme = re.sub("<!-- run( live)? -->", "<!-- not run: a copy -->", (ROOT / "README.md").read_text())
    planted["sim --captrue: no such option"] = ("README.md", readme.replace(" --capture ", " --captrue ", 1))
    table = "| seen | message |\n|---|---|\n| x | `{}` |\n"
    for message in ("the robot is lsot", "memory cannot be locked: … no such end"):
        planted[f"no program says `{message}`"] = ("docs/troubleshooting.md", table.format(message))
    wrong = [f"not found: {said}" for said, (name, text) in planted.items()
             if not any(said in fault for fault in faults_of(name, text))]
    message = table.format("memory cannot be locked: …; give LimitMEMLOCK=infinity")
    for name, text in (("good.md", GOOD), ("README.md", readme), ("docs/troubleshooting.md", message)):
        wrong += [f"refused: {fault}" for fault in faults_of(name, text)]
    print("\n".join([*wrong, f"docs: {len(planted)} planted, {len(wrong)} wrong"]))
    return bool(wrong)


if __name__ == "__main__":
    mode = sys.argv[1] if sys.argv[1:] and sys.argv[1] in {"--self-test", "--long"} else ""
    arguments = sys.argv[2:] if mode else sys.argv[1:]
    if len(arguments) < 3 or (mode == "--self-test" and len(arguments) > 3):
        sys.exit(__doc__)
    paths = [str(Path(p).resolve()) for p in arguments[:3]]
    known = dict(zip(("crspf", "crspfd"), paths))
    if mode == "--self-test":
        sys.exit(self_test(known, paths[2]))
    sys.exit(check_documents(known, paths[2], arguments[3:], mode == "--long"))
