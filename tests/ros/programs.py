"""Runs the programs of this folder for tests."""
import json
import os
import pathlib
import subprocess
import tempfile
import time

# DDS finds programs of one domain only, so that tests that run at once do not hear each other.
DOMAIN = 1 + os.getpid() % 100


def events(text, kind=None):
    """The JSON lines of a program, or those of one kind."""
    lines = [json.loads(line) for line in text.splitlines()]
    return [line for line in lines if kind is None or line["event"] == kind]


def as_lines(said):
    return "".join(json.dumps(line) + "\n" for line in said)


class Programs:
    """`prefix` goes before each command line: `ip netns exec NAME`."""

    def __init__(self, folder, domain=DOMAIN, prefix=()):
        self.folder, self.domain, self.prefix = pathlib.Path(folder), domain, list(prefix)

    def command(self, program, *arguments):
        in_domain = ["--domain", str(self.domain)] if program in ("ros_listen", "ros_say") else []
        return [*self.prefix, str(self.folder / program), *in_domain, *map(str, arguments)]

    def run(self, program, *arguments, input="", timeout=60):
        """Runs to its end; `input` is text, or bytes, and so is its output then."""
        return subprocess.run(self.command(program, *arguments), input=input, capture_output=True,
                              text=isinstance(input, str), timeout=timeout, check=False)

    def start_listening(self, *arguments):
        """ros_listen in the background, once its readers are there."""
        return Background(self.command("ros_listen", *arguments)).until_event("ready")

    def say(self, lines, *arguments):
        return self.run("ros_say", *arguments, input=as_lines(lines))

    def start_saying(self, lines, *arguments):
        """ros_say in the background."""
        return Background(self.command("ros_say", *arguments), as_lines(lines))


class Background:
    """A running program. Its output goes to a file: a full pipe would stop it."""

    def __init__(self, command, input=""):
        self.output = tempfile.TemporaryFile("w+")
        with tempfile.TemporaryFile("w+") as file:
            file.write(input)
            file.seek(0)
            self.process = subprocess.Popen(command, stdin=file, stdout=self.output)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.output.close()

    def events(self, kind=None):
        """What it printed until now, whole lines only."""
        text = os.pread(self.output.fileno(), os.fstat(self.output.fileno()).st_size, 0).decode()
        return events(text[:text.rfind("\n") + 1], kind)

    def until_event(self, kind, seconds=20):
        if not wait_for(lambda: self.events(kind) or self.process.poll() is not None, seconds) or not self.events(kind):
            self.__exit__()
            raise RuntimeError(f"no event '{kind}': {' '.join(self.process.args)}")
        return self

    def finish(self, kind=None, timeout=60):
        """Waits for its end; what it printed. Fails if the exit code is not 0."""
        if self.process.wait(timeout=timeout) != 0:
            raise RuntimeError(f"exit code {self.process.returncode}: {' '.join(self.process.args)}")
        return self.events(kind)

    def stop(self, kind=None):
        """Tells it to end."""
        self.process.terminate()
        return self.finish(kind)


def wait_for(condition, seconds=10):
    """Whether the condition became true in time."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True
