"""Chromium with a page, for tests."""
import json
import pathlib
import subprocess
import time


class Browser:
    """`with Browser(modules) as browser:` one Chromium, one page at a time. `prefix` goes before the command line."""

    def __init__(self, node, modules, prefix=()):
        self.command = [*prefix, node, str(pathlib.Path(__file__).with_name("browser.mjs")), str(modules)]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.wait(20)
        self.process.stdout.close()

    def ask(self, do, **command):
        self.process.stdin.write(json.dumps({"do": do, **command}) + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            raise RuntimeError(f"the browser ended: {self.process.wait()}")
        answer = json.loads(answer)
        if "error" in answer:
            raise RuntimeError(answer["error"])
        return answer["value"]

    def open(self, url, width=1280, height=800, scheme="dark", cuts=False):
        """`cuts`: one frame of the map arrives without its end."""
        self.ask("open", url=url, width=width, height=height, scheme=scheme, cuts=cuts)

    def evaluate(self, expression):
        """The value of JavaScript, as JSON; a promise is awaited."""
        return self.ask("evaluate", expression=expression)

    def octoskin(self, call):
        """What `window.octoskin` (host/bridge/page/src/inspection.js) answers: octoskin("pick(10, 20)")."""
        return self.evaluate(f"window.octoskin.{call}")

    def until(self, expression, seconds=60):
        """Waits until JavaScript gives something true; returns it. Raises AssertionError."""
        end = time.monotonic() + seconds
        while not (value := self.evaluate(expression)):
            if time.monotonic() > end:
                raise AssertionError(f"not within {seconds} s: {expression}")
            time.sleep(0.05)
        return value
