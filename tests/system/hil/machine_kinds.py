"""The two kinds of machine: this one, with interfaces, mounts and processes of its own, and a virtual one."""
import contextlib
import errno
import fcntl
import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
PROJECT = HERE.parents[2]
KERNEL = pathlib.Path(os.environ.get("OCTOSKIN_HIL_KERNEL", PROJECT / "build/hil_kernel"))
TIME_OVER, BROKEN = 124, 125
BOOT_S = 240      # 5 s on an idle machine
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
