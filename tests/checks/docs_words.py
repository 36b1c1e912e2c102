"""What documents say of commands, against what the programs (by their --help) and this repository know. See docs.py."""
import functools
import re
import shlex
import subprocess
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
# Programs of others that documents may name; a word that is not among them is a slip of the pen, or belongs here.
PROGRAMS = set("adduser apt awk basename candump cat cmake cp cpupower dmesg echo fuser getent grep head hexdump id "
               "install ip journalctl ls mkdir mosquitto_sub node openssl printf python3 reboot scp sed ss stat sudoedit "
               "systemctl tail tcpdump tee timedatectl udevadm umask uname usermod v4l2-ctl wc".split())
# What runs another program, and its options that have a value.
WRAPPERS = {"sudo": {"-u"}, "systemd-run": {"-p"}, "ssh": {"-L"}, "timeout": {"-s"}, "watch": {"-n"}}
INSTALLED = {"/usr/share/crspf/": "config/", "/etc/crspf/crspfd.toml": "config/crspfd.toml"}


class Option(NamedTuple):
    takes_value: bool
    more_values: bool
    choices: tuple


class Help(NamedTuple):
    options: dict
    commands: frozenset
    command_wanted: bool
    words_wanted: bool


def simple_commands(text):
    """Lists of words, without assignments, redirections and what a here-document holds."""
    text = re.sub(r"<<-?\s*'?(\w+)'?(.*?)\n.*?^\1$", r"\2", text, flags=re.S | re.M).replace("\\\n", " ")
    for substituted in re.findall(r"\$\(([^()]*)\)", text):
        yield from simple_commands(substituted)
    for line in re.sub(r"\$\([^()]*\)", "SUBSTITUTED", text).splitlines():
        lexer = shlex.shlex(line, posix=True, punctuation_chars="();<>|&")
        lexer.whitespace_split = True
        words, redirected = [], False
        for token in [*lexer, ";"]:
            if set(token) <= set("<>&") and set(token) & set("<>"):
                redirected = True
            elif set(token) <= set("();|&"):
                if words:
                    yield words
                words = []
            elif redirected:
                redirected = False
            elif words or not re.match(r"\w+=", token):
                words.append(token)


@functools.cache
def help_of(*command):
    said = subprocess.run([*command, "--help"], capture_output=True, text=True, check=True).stdout
    options, commands, section = {}, set(), ""
    for line in said.splitlines():
        if re.match(r"\S.*:$", line):
            section = line
        option = re.match(r" {2,4}(?:-\w,)?(--[\w-]+)(?: (\S.*)| .*)?$", line)
        if option:
            value = re.split(r" {2,}", option[2] or "")[0]
            choices = re.search(r":\{([^}]*)\}", value)
            takes_value = bool(value) and not value.startswith("Excludes:")
            options[option[1]] = Option(takes_value, " x " in value or "..." in value,
                                        tuple(choices[1].split(",")) if choices else ())
        elif section == "Subcommands:" and re.match(r"  \S", line):
            commands.add(line.split()[0])
    usage = re.search(r"^Usage: .*$", said, re.M)[0]
    return Help(options, frozenset(commands), bool(re.search(r"(?<!\[)SUBCOMMAND$", usage)), "Positionals:" in said)


def faults_of_call(program, words, in_text):
    """What is wrong with these words behind the program's name. In running text a command need not be whole."""
    command, known = [program], help_of(program)
    options = dict(known.options)
    words, stray, more = list(words), False, False
    while words:
        word = words.pop(0)
        if re.match(r"-[^\d.]", word):
            name, equals, value = word.partition("=")
            if name not in options and name != "-h":
                return [f"{' '.join(command[1:])} {name}: no such option"]
            option = options.get(name, Option(False, False, ()))
            more = option.more_values
            if option.takes_value and not equals:
                if not words or words[0].startswith("--"):
                    if not in_text:
                        return [f"{name}: without its value"]
                    continue
                value = words.pop(0)
            if option.choices and value not in option.choices and not (in_text and value.isupper()):
                return [f"{name} {value}: none of {', '.join(option.choices)}"]
        elif set(re.split(r"\\?\|", word)) <= known.commands and not stray:
            alternatives = re.split(r"\\?\|", word)
            if len(alternatives) > 1:
                return [fault for one in alternatives
                        for fault in faults_of_call(program, [*command[1:], one, *words], in_text)]
            command.append(word)
            known = help_of(*command)
            options |= known.options  # those of the parents hold, too
        elif known.command_wanted or not (known.words_wanted or more):
            placeholder = in_text and re.fullmatch(r"\[?[A-Z.]+\]?|\.\.\.|…", word)
            return [] if placeholder else [f"{' '.join(command[1:])} {word}: no such sub-command or word"]
        else:
            stray = True
    return [] if in_text or not known.command_wanted else ["a sub-command is missing"]


def unwrapped(words):
    """(what is run, its words) by sudo and the like."""
    while words and words[0] in WRAPPERS:
        with_value, name = WRAPPERS[words[0]], words[0]
        words = words[1:]
        while words and words[0].startswith("-"):
            words = words[2:] if words[0] in with_value else words[1:]
        if name in {"ssh", "timeout", "watch"} and len(words) > 1:
            words = words[1:]  # the host, the time
    return words


def faults_of_file(word):
    for installed, here in INSTALLED.items():
        if word.startswith(installed):
            word = here + word.removeprefix(installed)
    if re.match(r"(config|core|drivers|platform|tools|tests|toolchains)/", word) and not list(ROOT.glob(word)):
        return [f"{word}: not in this repository"]
    return []


def faults_of_command(words, programs, in_text=False):
    words = unwrapped(words)
    if not words:
        return []
    name = Path(words[0]).name
    faults = [fault for word in words for fault in faults_of_file(word)]
    if name in programs:
        return faults + faults_of_call(programs[name], words[1:], in_text)
    if name in {"systemctl", "journalctl"}:
        units = [word.removesuffix(".service") for word in words if word.startswith("crspf")]
        faults += [f"{unit}: no unit" for unit in units if not (ROOT / f"config/systemd/{unit}.service").exists()]
    if name == "cmake" and "--preset" in words:
        preset = words[words.index("--preset") + 1]
        faults += [] if f'"name": "{preset}"' in (ROOT / "CMakePresets.json").read_text() else [f"{preset}: no preset"]
    if "/" in words[0] and (ROOT / words[0]).is_file():
        return faults
    if words[0].startswith("build/") and any(re.search(rf"\b{name.removeprefix('fuzz_')}\b", f.read_text())
                                             for f in (ROOT / "tests").rglob("CMakeLists.txt")):
        return faults
    return faults + ([] if name in PROGRAMS else [f"{words[0]}: a program that tests/checks/docs.py does not know"])
