"""A robot PC in a folder, with a live robot, for the commands of the documents. See docs.py."""
import lzma
import os
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BLOCK_S, LONG_BLOCK_S = 120, 3600  # no block takes as long

SHIM = r"""#!/usr/bin/env bash
# crspf as a robot PC has it: there is a service, its socket is here, and what ends on Ctrl-C gets one.
set -euo pipefail
sub=${1:-}
case " $* " in
    *' --help '*) exec "$CRSPF" "$@" ;;
esac
if [[ $sub == ctl || $sub == top || ($sub == view && " $* " != *.pcapng\ *) ]]; then
    [[ -S $SANDBOX/control ]] || crspfd --config "$SANDBOX/robot.toml"
    set -- "$@" --socket "$SANDBOX/control"
fi
[[ $sub != view ]] || set -- "$@" --port 0
[[ $sub != record ]] || set -- "$@" --keep-free 1
case " $* " in
    *' --duration '* | *' --once '*) exec "$CRSPF" "$@" ;;
    ' record '* | ' view '* | ' top '*) exec timeout --foreground --preserve-status --signal=INT 3 "$CRSPF" "$@" ;;
esac
exec "$CRSPF" "$@"
"""
SERVICE_SHIM = r"""#!/usr/bin/env bash
# crspfd in the background, until its pose is known.
set -euo pipefail
case " $* " in
    *' --check '* | *' --help '*) exec "$CRSPFD" "$@" ;;
esac
if [[ -f $SANDBOX/service.pid ]]; then
    kill "$(<"$SANDBOX/service.pid")" 2>/dev/null || true
    for _ in $(seq 100); do [[ ! -S $SANDBOX/control ]] || sleep 0.1; done
fi
"$CRSPFD" "$@" --allow-degraded >"$SANDBOX/service.log" 2>&1 </dev/null &
echo $! >"$SANDBOX/service.pid"
for _ in $(seq 300); do
    "$CRSPF" ctl --socket "$SANDBOX/control" pose --json >"$SANDBOX/pose" 2>/dev/null || true
    ! grep -qs '"lost": false' "$SANDBOX/pose" || exit 0
    sleep 0.1
done
cat "$SANDBOX/service.log" >&2
echo 'the service does not find its pose' >&2
exit 1
"""


class Sandbox:
    """Programs, a live robot, its service when asked for, and the recordings that documents speak of."""

    def __init__(self, crspf, crspfd, live_robot, long=False):
        self.root = Path(tempfile.mkdtemp())
        recordings = Path(os.environ.get("CRSPF_DATA", "/nonexistent"))
        self.recordings = recordings if long and (recordings / "carmen").exists() else None
        self.runs = {"run", "run live"}  # blocks of these comments
        self.runs |= {"run long"} if long else set()
        self.runs |= {"run long: recordings"} if self.recordings else set()
        self.block_s = LONG_BLOCK_S if long else BLOCK_S
        self.robot = None
        (self.root / "bin").mkdir()
        (self.root / "home").mkdir()
        for name, text in (("crspf", SHIM), ("crspfd", SERVICE_SHIM), ("sudo", '#!/bin/sh\nexec "$@"\n')):
            (self.root / "bin" / name).write_text(text)
            (self.root / "bin" / name).chmod(0o755)
        self.environment = {"PATH": f"{self.root}/bin:{os.environ['PATH']}", "HOME": f"{self.root}/home",
                            "LC_ALL": "C.UTF-8", "SANDBOX": str(self.root), "CRSPF": crspf, "CRSPFD": crspfd}
        self.crspf, self.live_robot = crspf, live_robot
        (self.root / "etc/crspf").mkdir(parents=True)
        shutil.copy(ROOT / "config/crspfd.toml", self.root / "etc/crspf")
        (self.root / "share").mkdir()
        (self.root / "share/crspf").symlink_to(ROOT / "config")

    def begin(self):
        subprocess.run([self.crspf, "sim", "--duration", "60", "--capture", "drive.pcapng", "--out", "sim"],
                       cwd=self.root, check=True, capture_output=True)
        (self.root / "log.clf.xz").write_bytes(lzma.compress((self.root / "sim/log.clf").read_bytes(), preset=0))
        if "run long" in self.runs:
            (self.root / "pictures").mkdir()
            subprocess.run([ROOT / "tests/checks/chessboard.py", self.root / "pictures"], check=True)
        if self.recordings:
            (self.root / "kitti").mkdir()
            subprocess.run(["tar", "-xf", self.recordings / "stereo/kitti_1.tar", "-C", self.root / "kitti"], check=True)
        with socket.socket(type=socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            base = f"udp://127.0.0.1:{free.getsockname()[1]}"
        toml = subprocess.run([self.live_robot, "--config", f"{self.root}/tty", base], check=True, capture_output=True,
                              text=True).stdout
        (self.root / "robot.toml").write_text(
            toml + f'\n[service]\ncontrol_socket = "{self.root}/control"\nstate_directory = "{self.root}/state"\n')
        self.robot = subprocess.Popen([self.live_robot, f"{self.root}/tty", base], stdin=subprocess.PIPE,
                                      stdout=subprocess.DEVNULL)

    def folder(self, name, live=False):
        """Where a document's blocks run: what a reader has by then."""
        folder = self.root / "documents" / name
        if folder.exists():
            return folder
        folder.mkdir(parents=True)
        if live:
            shutil.copy(self.root / "robot.toml", folder)
        else:
            (folder / "runs").mkdir()
            places = {"run.pcapng": self.root / "drive.pcapng", "intel.clf.xz": self.root / "log.clf.xz",
                      "runs/crspf-20260101T120000Z.pcapng": self.root / "drive.pcapng"}
            if "run long" in self.runs:
                places["pictures"] = self.root / "pictures"
            if self.recordings:
                places |= {file.name: file for file in (self.recordings / "carmen").iterdir()}
                places["kitti"] = self.root / "kitti"
            for link, to in places.items():
                (folder / link).symlink_to(to)
        for directory in ("config", "drivers", "tests", "tools"):
            (folder / directory).symlink_to(ROOT / directory)
        for program in ("tools/crspf/crspf", "platform/crspfd/crspfd"):
            link = folder / "build/release" / program
            link.parent.mkdir(parents=True)
            link.symlink_to(self.root / "bin" / link.name)
        return folder

    def here(self, text, live=False):
        """The text with this robot PC's places."""
        if live:
            text = text.replace("/etc/crspf/crspfd.toml", str(self.root / "robot.toml"))
        for path, place in (("/etc/crspf", "etc/crspf"), ("/usr/share/crspf", "share/crspf"),
                            ("/var/lib/crspf", "state")):
            text = re.sub(rf"(?<!\w){path}\b", str(self.root / place), text)  # not what stands in such a place
        return text

    def run(self, text, folder, live=False):
        """What is wrong with it; empty: it went well."""
        with tempfile.TemporaryFile("w+") as said:
            process = subprocess.Popen(["bash", "-euo", "pipefail", "-c", self.here(text, live)], cwd=folder,
                                       env=self.environment, stdin=subprocess.DEVNULL, stdout=said, stderr=said,
                                       start_new_session=True)
            try:
                status = process.wait(timeout=self.block_s)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                status = process.wait()
            said.seek(0)
            return "" if status == 0 else f"exit status {status}\n{said.read()}"

    def stop_service(self):
        """And what it has kept goes: the next document begins with another robot."""
        pid = self.root / "service.pid"
        if pid.exists():
            try:
                os.kill(int(pid.read_text()), signal.SIGTERM)
                for _ in range(100):
                    if not (self.root / "control").exists():
                        break
                    time.sleep(0.1)
            except ProcessLookupError:
                pass
            pid.unlink()
        shutil.rmtree(self.root / "state", ignore_errors=True)

    def end(self):
        self.stop_service()
        if self.robot:
            self.robot.kill()
            self.robot.wait()
        shutil.rmtree(self.root)
