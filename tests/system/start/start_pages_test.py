#!/usr/bin/env python3
"""Runs the commands of the start pages.

usage: start_pages_test.py SOURCES BUILD

Each command of a page has one entry below, and each entry is a command of its page. A command runs as printed, or as
its entry says where it would need a board, the system's services or another folder. A command that only installs,
builds or opens a viewer has the entry None: its reason is beside it.
"""
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

SOURCES, BUILD = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
BIN = "build/host-release/bin/"
RIG = "hw/rigs/bench_one_board.yaml"
BRIDGE = "octoskin bridge --socket control --joints joints --status-socket bridge"
SAMPLES = "for i in $(seq 30); do echo 0 -0.785 0 -2.356 0 1.571 0.785; sleep 0.1; done"  # of a driver

INSTALLS = BUILDS = HARDWARE = SERVICE = VIEWER = None


class Run:
    """A command as it is run here, and a text that its output contains. Its exit code must be 0."""

    def __init__(self, command=None, says=""):
        self.command, self.says = command, says


PAGES = {
    "simulation": {
        "sudo apt install git": INSTALLS,
        "git clone <this repository> octoskin && cd octoskin": INSTALLS,
        # What ./demo --quick runs after the build.
        "./demo": Run(BIN + "octoskin-lab experiment --seeds 0 --configurations fast --jobs 2 --out out/demo",
                      says="report.html"),
        "sudo apt install octovis": INSTALLS,
        "octovis out/demo/fused.bt": VIEWER,
        "cmake --build --preset host-release --target octoskin": BUILDS,
        BIN + "octoskin replay out/demo/recording --configuration fast":
            Run(BIN + "octoskin replay out/demo/recording --configuration fast && for map in depth proximity fused; do "
                "cmp out/demo/$map.ot out/demo/recording/maps/$map.ot || exit 1; done"),
        BIN + "octoskin explain 0.67 0.34 0.29 --recording out/demo/recording": Run(says="the camera never saw it"),
        BIN + "octoskin query out/demo/fused.ot --rig out/demo/recording/rig.yaml "
              "--joints 0,-0.785,0,-2.356,0,1.571,0.785 --own-space 0.1 --stands=...":
            Run(BIN + "octoskin query out/demo/fused.ot --rig out/demo/recording/rig.yaml "
                "--joints 0,-0.785,0,-2.356,0,1.571,0.785 --own-space 0.1 --stands=0,-0.785,0,-2.356,0,1.571,0.785",
                says="free"),
        BIN + "octoskin-lab evaluate out/demo/recording": Run(says="f1"),
        BIN + "octoskin-lab evaluate out/demo/fused.ot --rig out/demo/recording/rig.yaml": Run(says="f1"),
        BIN + "octoskin rig hw/rigs/bench_one_board.yaml": Run(),
        BIN + "octoskin-lab simulate out/bench --rig hw/rigs/bench_one_board.yaml --scenario "
              "hw/worlds/bench.scenario.yaml": Run(),
        BIN + "octoskin replay out/bench": Run(),
        "toolchains/install_packages flash && sudo apt install libunicorn-dev": INSTALLS,
        "cmake --preset firmware-release && cmake --build --preset firmware-release": BUILDS,
        "cmake --preset host-release -DOCTOSKIN_EMULATED_BOARD=ON": BUILDS,
        "cmake --build --preset host-release --target octoskin_board": BUILDS,
        # system.board and the board tests run the emulated board; here only the option is checked.
        BIN + "octoskin-lab simulate out/emulated --board emulated":
            Run(BIN + "octoskin-lab simulate --help", says="--board"),
    },
    "one-board": {
        "toolchains/install_packages product flash": INSTALLS,
        "sudo apt install can-utils iproute2": INSTALLS,
        "cmake --preset host-release": BUILDS,
        "cmake --build --preset host-release --target octoskin_package --parallel": BUILDS,
        "sudo apt install ./build/host-release/octoskin_0.1.0_amd64.deb": INSTALLS,
        "sudo usermod -aG plugdev,dialout $USER": INSTALLS,
        # Without a board: the options are checked, as far as the order to build the image.
        f"firmware/flash --rig {RIG} --node bench --write-option-bytes":
            Run("octoskin flash --help", says="--write-option-bytes"),
        "sudo ip link set can0 up type can bitrate 500000 sample-point 0.8 restart-ms 100": HARDWARE,
        "candump can0,141:7FF": HARDWARE,
        "stty -F /dev/ttyACM0 115200 raw && cat /dev/ttyACM0": HARDWARE,
        f"octoskin run --rig {RIG} --can can0 --no-camera --maps $(mktemp -d)/maps":
            Run("DAEMON"),
        "octoskin monitor": Run("octoskin monitor --once --socket control", says="no joint states"),
    },
    "beside-a-robot": {
        "sudo systemctl enable --now systemd-networkd": SERVICE,
        "ip -details link show can0": HARDWARE,
        "sudo cp -rT /usr/share/octoskin/hw /etc/octoskin": SERVICE,
        "sudo cp my_rig.yaml /etc/octoskin/rigs/my_rig.yaml": SERVICE,
        "octoskin rig /etc/octoskin/rigs/my_rig.yaml": Run(f"octoskin rig {RIG}"),
        "sudoedit /etc/default/octoskin": SERVICE,
        "sudo systemctl enable --now octoskin": SERVICE,
        'sudo adduser "$USER" octoskin': SERVICE,
        "octoskin status": Run("octoskin status --socket control", says="no joint states"),
        "my_arm_driver --print-joints | octoskin joints":
            Run(f"{SAMPLES} | octoskin joints --socket joints", says="30 lines sent"),
        "octoskin monitor": Run("octoskin monitor --once --socket control", says="joint"),
        "octoskin query --own-space 0.1":
            # A loaded machine starts the commands late: the query waits for the arm's posture.
            Run(f"({SAMPLES} | octoskin joints --socket joints) & for i in $(seq 8); do "
                "octoskin query --own-space 0.1 --socket control && exit 0; sleep 0.2; done; exit 1", says="free"),
        "octoskin record /var/lib/octoskin/bench --seconds 60":
            Run("octoskin record $PWD/bench --seconds 1 --socket control"),
    },
    "moveit": {
        "toolchains/install_packages product bridge view": INSTALLS,
        "cmake --preset host-release": BUILDS,
        "cmake --build --preset host-release --target octoskin_package --parallel": BUILDS,
        "sudo apt install ./build/host-release/octoskin_0.1.0_amd64.deb "
        "./build/host-release/octoskin-bridge_0.1.0_amd64.deb": INSTALLS,
        # tests/ros publishes a robot and saves it; here nothing publishes one.
        "octoskin bridge robot arm.urdf":
            Run("octoskin bridge robot arm.urdf --seconds 1 || test $? = 69"),
        "octoskin robot arm.urdf --out arm_fitted.urdf":
            Run("octoskin robot hw/robots/panda.urdf --out arm_fitted.urdf", says="panda"),
        "octoskin rig my_rig.yaml": Run(f"octoskin rig {RIG}"),
        "octoskin bridge":
            Run(f"{BRIDGE} 2>bridge.log & for i in $(seq 100); do grep -q 'daemon with rig' bridge.log && break; "
                "sleep 0.1; done; kill $!; wait $!; cat bridge.log", says="daemon with rig"),
        "sudo systemctl enable --now octoskin-bridge": SERVICE,
        "octoskin bridge status":
            Run(f"{BRIDGE} & for i in $(seq 100); do octoskin bridge status --socket bridge && break; sleep 0.1; done; "
                "ended=$?; kill $!; exit $ended", says="other participants"),
    },
    "view": {
        "toolchains/install_packages product bridge view": INSTALLS,
        "cmake --preset host-release": BUILDS,
        "cmake --build --preset host-release --target octoskin_package --parallel": BUILDS,
        "sudo apt install ./build/host-release/octoskin_0.1.0_amd64.deb "
        "./build/host-release/octoskin-bridge_0.1.0_amd64.deb": INSTALLS,
        "octoskin view": Run("(octoskin view --socket control --port 0 & sleep 3; kill $!; wait $!) 2>&1",
                             says="the view is at http://127.0.0.1:"),
    },
    "ros-camera": {
        # tests/ros publishes images and frames; here nothing publishes them.
        "octoskin bridge pose --rig my_rig.yaml > my_cell.yaml":
            Run(f"printf 'extends: {SOURCES}/hw/rigs/experiment.yaml\ncamera: {{device: \"ros:/depth\", pose: tf}}\n' "
                "> my_rig.yaml; octoskin bridge pose --rig my_rig.yaml --seconds 1 > my_cell.yaml || test $? = 69"),
        "octoskin rig my_cell.yaml": Run(f"octoskin rig {RIG}"),
        "sudo cp /usr/share/doc/octoskin-bridge/examples/octoskin-bridge.sysctl "
        "/etc/sysctl.d/60-octoskin-bridge.conf": SERVICE,
        "sudo sysctl --system": SERVICE,
        "octoskin run --rig my_cell.yaml --can can0 --joints $XDG_RUNTIME_DIR/octoskin-joints": HARDWARE,
        "octoskin bridge": SERVICE,
        "octoskin bridge status": SERVICE,
        "octoskin status": Run("octoskin status --socket control", says="map:"),
    },
}


def commands_of(page):
    """The commands of the page's shell blocks, without comments, continued lines joined."""
    text = (SOURCES / "docs/start" / f"{page}.md").read_text()
    for language, block in re.findall(r"^```(\w*)\n(.*?)^```", text, re.S | re.M):
        if language not in ("", "sh"):
            continue
        for line in block.replace("\\\n", " ").splitlines():
            command = re.sub(r"\s+", " ", re.sub(r"\s+#.*", "", line)).strip()
            is_setting = re.match(r"(\[|#|\w+=)", command)  # lines of a configuration file
            if command and not is_setting:
                yield command


def start_daemon(environment):
    daemon = subprocess.Popen(
        ["octoskin", "run", "--rig", RIG, "--can", "nocan0", "--no-camera", "--maps", "maps", "--socket", "control",
         "--joints", "joints"], env=environment, stderr=subprocess.PIPE, text=True)
    until = time.monotonic() + 20
    while time.monotonic() < until and daemon.poll() is None and not pathlib.Path("control").exists():
        time.sleep(0.05)
    assert daemon.poll() is None and pathlib.Path("control").exists(), "the daemon did not start"
    return daemon


def run(page, printed, how, environment):
    command = how.command or printed
    ended = subprocess.run(command, shell=True, env=environment, text=True, timeout=150,
                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    print(f"{page}: {command}: {ended.returncode}", flush=True)
    if ended.returncode == 0 and how.says in ended.stdout:
        return True
    print(f"expected exit code 0 and '{how.says}', found:\n{ended.stdout}", flush=True)
    return False


def main():
    faults = 0
    for page, entries in PAGES.items():
        printed = list(commands_of(page))
        for command in set(printed) ^ set(entries):
            faults += 1
            print(f"{page}: {'no entry in the test' if command in printed else 'not on the page'}: {command}")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        pathlib.Path("build/host-release").mkdir(parents=True)
        pathlib.Path(BIN).symlink_to(BUILD / "bin")
        for name in ("hw", "host", "docs"):
            pathlib.Path(name).symlink_to(SOURCES / name)
        environment = {**os.environ, "PATH": f"{BUILD / 'bin'}:{os.environ['PATH']}"}
        daemon = None
        try:
            for page in PAGES:
                for printed in commands_of(page):
                    how = PAGES[page].get(printed)
                    if how is None:
                        continue
                    if how.command == "DAEMON":
                        daemon = start_daemon(environment)
                    else:
                        faults += not run(page, printed, how, environment)
        finally:
            if daemon is not None:
                daemon.send_signal(signal.SIGTERM)
                daemon.communicate(timeout=30)
    sys.exit(1 if faults else 0)


main()
