#!/usr/bin/env python3
"""A machine with a real kernel's CAN, GPIO and I2C, in which commands are run one by one.

    machine.py boot [--bin FOLDER] [--disk FILE] [--bare] FOLDER
                                                     start it, leave it running; bare: with CAN, without the boards;
                                                     with a disk, made if it is not there
    machine.py run [--seconds N] FOLDER COMMAND...   run a command inside; its output and exit code become ours
    machine.py stop FOLDER
    machine.py cut FOLDER                            its power is gone: what it had not flushed to its disk is lost

FOLDER holds what is known of the machine: its console, and of each command the script, the output and the exit code.
Where this kernel has what it takes, the machine is this one, with interfaces, processes and /run of its own; else a virtual one,
with this machine's own files, read-only, whose only place to write to is FOLDER. boot says which, and why; OCTOSKIN_HIL=native or
OCTOSKIN_HIL=virtual decides.
Exit codes of its own: 77 nothing to boot with, 124 a time limit is over, 125 the machine is not as it should be.
"""
import argparse
import contextlib
import errno
import fcntl
import os
import pathlib
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
PROJECT = HERE.parents[2]
KERNEL = pathlib.Path(os.environ.get("OCTOSKIN_HIL_KERNEL", PROJECT / "build/hil_kernel"))
SKIPPED, TIME_OVER, BROKEN = 77, 124, 125
BOOT_S = 240      # 5 s on an idle machine
PREPARE_S = 120
UNDO_S = 20
ANSWER_S = 60     # longer than the command may take: then the machine hangs
LIFE_S = 1800     # a machine that nobody stops ends by itself
KERNEL_OPTIONS = ("console=ttyS0 quiet panic=-1 mitigations=off nosmap nosmep tsc=unstable clocksource=hpet "
                  "idle=halt")
QEMU = "qemu-system-x86_64"
BUSYBOX = pathlib.Path("/bin/busybox")
# Of a native machine's commands, as init.sh's.
ENVIRONMENT = {"PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/run", "TMPDIR": "/run",
               "LC_ALL": "C.UTF-8", "PYTHONDONTWRITEBYTECODE": "1"}  # nothing of root's in the source tree
# As board.sh wires them.
BOARD_DEVICES = [pathlib.Path(f"/dev/i2c-{bus}") for bus in (7, 8, 9, 10)]


class MachineError(Exception):
    """Says what is wrong, and with which exit code to end."""

    def __init__(self, message, code=BROKEN):
        super().__init__(message)
        self.code = code


def wait_for(is_done, seconds):
    """Asks every 20 ms; False once the time is over."""
    end = time.monotonic() + seconds
    while not is_done():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


class Machine:
    """What the two kinds share: the folder, the process that is the machine, and a command as a script in the folder."""
    kind: str

    def __init__(self, folder):
        self.folder = folder

    def start(self, command, log):
        """Until it is up. The name of its folder is in the command."""
        with open(self.folder / log, "wb") as output:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output, stderr=output, start_new_session=True)
        (self.folder / "pid").write_text(str(process.pid))
        is_up = wait_for(lambda: (self.folder / "up").exists() or process.poll() is not None, BOOT_S)
        if not is_up or process.poll() is not None:
            self.kill()
            raise MachineError(self.with_tail("it does not boot" if is_up else f"it did not boot within {BOOT_S} s"))

    def pid(self):
        """Of what `start` started; None if it is gone."""
        try:
            pid = int((self.folder / "pid").read_text())
            is_ours = str(self.folder).encode() in pathlib.Path(f"/proc/{pid}/cmdline").read_bytes()
        except (OSError, ValueError):
            return None
        return pid if is_ours else None

    def is_running(self):
        return self.pid() is not None

    def kill(self):
        if pid := self.pid():
            os.killpg(pid, signal.SIGKILL)

    def with_tail(self, message):
        lines = [message]
        for name in ("qemu.log", "console"):
            with contextlib.suppress(OSError):
                text = (self.folder / name).read_text(errors="replace").splitlines()[-25:]
                lines += [f"-- the end of {self.folder / name}:", *text]
        return "\n".join(lines)

    @contextlib.contextmanager
    def alone(self):
        """One command at a time: another waits its turn."""
        with open(self.folder / "lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            yield

    def write_script(self, name, command):
        """The environment is what board.sh left, and how much a check shall do: OCTOSKIN_HIL_*."""
        script = self.folder / f"{name}.sh"
        asked = [f"export {key}={shlex.quote(value)}" for key, value in os.environ.items() if key.startswith("OCTOSKIN_HIL_")]
        script.write_text("\n".join([*asked, f"export HIL_KIND={self.kind}",
                                     f"[ ! -e {self.quoted('board.env')} ] || . {self.quoted('board.env')}",
                                     f"exec {shlex.join(command)}\n"]))
        return script

    def quoted(self, name):
        return shlex.quote(str(self.folder / name))

    def next_name(self):
        return f"{len(list(self.folder.glob('*.sh'))):03}"

    def run(self, command, seconds):
        with self.alone():
            return self.run_script(self.next_name(), command, seconds)


def own_namespaces(*command):
    """The command, as the first process of network, mounts and processes of its own, which end with it. Who is not root is root in
    there, over these alone."""
    user = [] if is_root() else ["--map-root-user"]
    return ["unshare", "--net", "--mount", "--pid", "--fork", "--kill-child", *user, *map(str, command)]


def is_root():
    return os.geteuid() == 0


def as_a_shell_gives_it(returncode):
    """Python tells the signal that ended a program as a negative number."""
    return 128 - returncode if returncode < 0 else returncode


class NativeMachine(Machine):
    """This kernel, with interfaces, mounts and processes of its own."""
    kind = "native"

    def boot(self):
        self.start(["timeout", "-k", str(UNDO_S), str(LIFE_S), *own_namespaces(HERE / "native_init.sh", self.folder)], "console")

    def first_process(self):
        """As this machine numbers it; None if it is gone, or not yet there."""
        with contextlib.suppress(OSError, ValueError):
            if self.is_running():
                first = int((self.folder / "first").read_text())
                if str(self.folder).encode() in pathlib.Path(f"/proc/{first}/cmdline").read_bytes():
                    return first
        return None

    def entered(self, *command):
        """The command, so that it is run inside."""
        first = self.first_process()
        if first is None:
            raise MachineError(self.with_tail("it is not running"))
        user = [] if is_root() else ["--user", "--preserve-credentials"]
        return ["nsenter", "--target", str(first), "--net", "--mount", "--pid", "--root", "--wd", *user, *map(str, command)]

    def run_script(self, name, command, seconds):
        script = self.write_script(name, command)
        with open(self.folder / f"{name}.out", "wb") as output:
            done = subprocess.run(self.entered("timeout", "-k", "2", seconds, "bash", script), stdin=subprocess.DEVNULL,
                                  stdout=output, stderr=output, env=ENVIRONMENT, check=False)
        code = as_a_shell_gives_it(done.returncode)
        (self.folder / f"{name}.code").write_text(f"{code}\n")
        return code, (self.folder / f"{name}.out").read_bytes()

    def kill(self):
        """Its first process undoes what it made, if it still can."""
        if first := self.first_process():
            os.kill(first, signal.SIGTERM)
        if not wait_for(lambda: not self.is_running(), UNDO_S):
            super().kill()

    def stop(self):
        self.kill()
        if not (self.folder / "undone").exists():
            raise MachineError(self.with_tail("it did not undo all that it made"))


class VirtualMachine(Machine):
    kind = "virtual"

    def __init__(self, folder, disk=None, processors=1):
        super().__init__(folder)
        self.disk = disk  # a file, to the machine /dev/vda
        self.processors = processors

    def boot(self):
        self.make_initramfs()
        if self.disk and not self.disk.exists():
            self.make_disk()
        for end in ("in", "out"):
            os.mkfifo(self.folder / f"control.{end}")
        self.start(self.qemu_command(), "qemu.log")

    def qemu_command(self):
        """Two processors where there are boards: nodes, sensors, daemon and camera are a dozen programs, and a reading that comes late
        is asked for again. Elsewhere one: two spend as much time again on waiting for each other. Of a kind without AVX, whose use by the C library takes a
        fifth more time when emulated. Never KVM: its device may be there and hang. Time by
        the HPET: the rate of the TSC is measured at the start, on a busy host several times too low. Idle by halt, and without checks that
        emulation only makes slower: a timer that wakes a program then costs a third less. What the machine flushes to its disk goes to the
        host's kernel, and nobody waits until it is on the host's disk (unsafe): it is QEMU whose power is cut, not the host's."""
        return [
            "timeout", "-k", "5", str(LIFE_S), QEMU, "-accel", "tcg,thread=multi", "-cpu", "Nehalem", "-m", "1G",
            "-smp", str(self.processors),
            "-nodefaults", "-display", "none", "-no-reboot", "-kernel", str(KERNEL / "vmlinux"),
            "-initrd", str(self.folder / "initramfs"), "-append", KERNEL_OPTIONS,
            "-chardev", f"file,id=console,path={self.folder}/console", "-serial", "chardev:console",
            "-chardev", f"pipe,id=control,path={self.folder}/control", "-serial", "chardev:control",
            "-fsdev", "local,id=root,path=/,security_model=none,readonly=on,multidevs=remap",
            "-device", "virtio-9p-pci,fsdev=root,mount_tag=host_files",
            "-fsdev", f"local,id=folder,path={self.folder},security_model=none,multidevs=remap",
            "-device", "virtio-9p-pci,fsdev=folder,mount_tag=host_folder",
            *(["-drive", f"file={self.disk},if=virtio,format=raw,cache=unsafe"] if self.disk else [])]

    def make_initramfs(self):
        """busybox, the modules, and init.sh, which gives the machine this machine's own files."""
        with tempfile.TemporaryDirectory() as name:
            tree = pathlib.Path(name)
            for folder in ("bin", "dev", "proc", "modules", "root"):
                (tree / folder).mkdir()
            shutil.copy(BUSYBOX, tree / "bin/busybox")
            shutil.copy(HERE / "init.sh", tree / "init")
            for module in (KERNEL / "modules.load").read_text().split():
                shutil.copy(KERNEL / "modules" / module, tree / "modules")
            shutil.copy(KERNEL / "modules.load", tree / "modules.load")
            (tree / "folder").write_text(str(self.folder))
            files = "\n".join(str(path.relative_to(tree)) for path in sorted(tree.rglob("*")))
            with open(self.folder / "initramfs", "wb") as initramfs:
                subprocess.run(["cpio", "--quiet", "-o", "-H", "newc"], cwd=tree, input=files.encode(), stdout=initramfs,
                               check=True)

    def make_disk(self):
        with open(self.disk, "wb") as disk:
            disk.truncate(32 << 20)
        path = os.environ["PATH"] + ":/usr/sbin:/sbin"
        subprocess.run(["mkfs.ext4", "-q", self.disk], check=True, env={**os.environ, "PATH": path})

    def tell(self, line):
        """One line to init.sh; it is there only if the machine runs."""
        try:
            control = os.open(self.folder / "control.in", os.O_WRONLY | os.O_NONBLOCK)
        except OSError as error:
            if error.errno in (errno.ENXIO, errno.ENOENT):
                raise MachineError(self.with_tail("it is not running")) from error
            raise
        with open(control, "w") as pipe:
            pipe.write(line + "\n")

    def run_script(self, name, command, seconds):
        self.write_script(name, command)
        code = self.folder / f"{name}.code"
        self.tell(f"{name} {seconds}")
        if not wait_for(code.exists, seconds + ANSWER_S):
            raise MachineError(self.with_tail(f"no answer to '{shlex.join(command)}' within {seconds + ANSWER_S} s"), TIME_OVER)
        return int(code.read_text()), (self.folder / f"{name}.out").read_bytes()

    def stop(self):
        with contextlib.suppress(MachineError):
            self.tell("off")
        if not wait_for(lambda: not self.is_running(), 10):
            self.kill()


def native_lacks(board):
    """Why a native machine cannot be; None if it can. Changes nothing, but that the kernel may load its module vcan."""
    if pathlib.Path("/run") in HERE.parents:
        return f"a native machine has a /run of its own, and {HERE} lies below it"
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except OSError as error:
        return f"this kernel has no CAN sockets ({error.strerror})"
    try:
        probe = subprocess.run(own_namespaces(HERE / "native_init.sh", "probe"), capture_output=True, text=True, check=False,
                               env=ENVIRONMENT)
    except OSError as error:
        return f"{error.filename}: {error.strerror}"
    if probe.returncode != 0:
        return f"this kernel has no vcan, or we have no right to make one ({' '.join(probe.stderr.split())})"
    return boards_lack() if board == "up" else None


def boards_lack():
    if not is_root():
        return "only root can make GPIO lines and I2C buses"
    if not pathlib.Path("/sys/kernel/config/gpio-sim").is_dir():
        return "there is no gpio-sim (modprobe gpio-sim)"
    if not pathlib.Path("/dev/cuse").exists():
        return "there is no CUSE (modprobe cuse)"
    # An adapter is there without its device, until somebody loads i2c-dev.
    there = [str(device) for device in BOARD_DEVICES
             if device.exists() or pathlib.Path("/sys/bus/i2c/devices", device.name).exists()]
    return f"{there[0]} is there already" if there else None


def virtual_lacks():
    """Why a virtual machine cannot be booted; None if it can."""
    if shutil.which(QEMU) is None:
        return f"{QEMU} is not installed (toolchains/install_packages hil)"
    if not BUSYBOX.exists() or shutil.which("cpio") is None:
        return "busybox-static or cpio is not installed (toolchains/install_packages hil)"
    if not (KERNEL / "modules.load").exists():
        return f"no kernel in {KERNEL} (toolchains/fetch_hil_kernel)"
    return None


def choose(asked, why_not_native, why_not_virtual):
    """(kind, why it is this one). `asked` is OCTOSKIN_HIL; the others tell what a kind lacks, None if nothing, and are only called if
    that decides."""
    if asked not in ("", "native", "virtual"):
        raise MachineError(f"OCTOSKIN_HIL={asked}: native, virtual, or nothing to have boot decide")
    if asked != "virtual":
        lacks = why_not_native()
        if lacks is None:
            has_all = "this kernel has what it takes (OCTOSKIN_HIL=virtual boots a virtual machine)"
            return "native", "OCTOSKIN_HIL=native" if asked else has_all
        if asked:
            raise MachineError(f"skipped: OCTOSKIN_HIL=native, but {lacks}", SKIPPED)
    if why := why_not_virtual():
        raise MachineError(f"skipped: {why}" + ("" if asked else f"; and without a virtual machine: {lacks}"), SKIPPED)
    return "virtual", "OCTOSKIN_HIL=virtual" if asked else lacks


def make_anew(folder):
    """Empty; a folder that was no machine's is not touched."""
    if folder.is_dir() and any(folder.iterdir()) and not any((folder / name).exists() for name in ("kind", "skipped", "pid")):
        raise MachineError(f"{folder} is not empty and not a machine's: name another folder")
    try:
        with contextlib.suppress(MachineError):
            machine_in(folder).kill()  # left over from a run that was broken off
        if folder.exists():
            shutil.rmtree(folder)
        folder.mkdir(parents=True)
    except OSError as error:
        raise MachineError(f"{error.filename or folder}: {error.strerror}; a machine of another user's? Its owner can stop and remove it") from error


def boot(folder, binaries, board, disk):
    make_anew(folder)
    try:
        boot_in(folder, binaries, board, disk)
    except MachineError as error:
        if error.code == SKIPPED:
            (folder / "skipped").write_text(str(error))
        raise


def boot_in(folder, binaries, board, disk):
    began = time.monotonic()
    kind, why = choose(os.environ.get("OCTOSKIN_HIL", ""), lambda: native_lacks(board), virtual_lacks)
    print(f"{kind} machine: {why}", flush=True)
    (folder / "kind").write_text(kind)
    machine = NativeMachine(folder) if kind == "native" else VirtualMachine(folder, disk, 2 if board == "up" else 1)
    machine.boot()
    up = time.monotonic()
    code, output = machine.run([str(HERE / "board.sh"), board, str(folder), str(binaries)], PREPARE_S)
    if code != 0:
        machine.kill()
        raise MachineError(output.decode(errors="replace").strip(), SKIPPED if code == SKIPPED else BROKEN)
    print(f"up after {up - began:.1f} s, its board after {time.monotonic() - up:.1f} s more")


def machine_in(folder):
    if (folder / "skipped").exists():
        raise MachineError((folder / "skipped").read_text(), SKIPPED)
    if not (folder / "kind").exists():
        raise MachineError(f"no machine in {folder}; boot it first")
    return NativeMachine(folder) if (folder / "kind").read_text() == "native" else VirtualMachine(folder)


def cut(folder):
    machine = machine_in(folder)
    if machine.kind == "native":
        raise MachineError("this machine's own power is not cut")
    machine.kill()


def run(folder, command, seconds):
    began = time.monotonic()
    code, output = machine_in(folder).run(command, seconds)
    sys.stdout.buffer.write(output)
    sys.stdout.flush()
    print(f"{time.monotonic() - began:.1f} s, exit code {code}" + (": time limit" if code == TIME_OVER else ""))
    return code


def parsed_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    for verb in ("boot", "run", "stop", "cut"):
        verbs.add_parser(verb).add_argument("folder", type=lambda text: pathlib.Path(text).resolve())
    verbs.choices["boot"].add_argument("--bin", type=pathlib.Path, default=PROJECT / "build/host-release/bin")
    verbs.choices["boot"].add_argument("--disk", type=pathlib.Path)
    verbs.choices["boot"].add_argument("--bare", dest="board", action="store_const", const="can", default="up")
    verbs.choices["run"].add_argument("--seconds", type=int, default=30)
    verbs.choices["run"].add_argument("command", nargs=argparse.REMAINDER)
    return parser.parse_args()


def main():
    arguments = parsed_arguments()
    try:
        if arguments.verb == "boot":
            boot(arguments.folder, arguments.bin.resolve(), arguments.board, arguments.disk)
        elif arguments.verb == "run":
            return run(arguments.folder, arguments.command, arguments.seconds)
        elif arguments.verb == "cut":
            cut(arguments.folder)
        else:
            machine_in(arguments.folder).stop()
    except MachineError as error:
        print(f"machine: {error}")
        return error.code
    return 0


if __name__ == "__main__":
    sys.exit(main())
