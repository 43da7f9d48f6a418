"""A daemon that has mapped a recording, and a view beside it, for tests."""
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "ros"))
from bridge_world import World  # noqa: E402
from programs import wait_for  # noqa: E402

ADDRESS = re.compile(r"the view is at http://127\.0\.0\.1:(\d+)/")


class ViewWorld(World):
    """`with ViewWorld(folder) as world:` `world.port` is the view's. `view_options`: of the command."""

    def __init__(self, programs, view_options=(), has_daemon=True, **options):
        super().__init__(programs, **options)
        self.view_options, self.has_daemon = list(view_options), has_daemon

    def start_daemon(self):
        if self.has_daemon:
            super().start_daemon()

    def play(self):
        if self.has_daemon:
            super().play()

    def start_bridge(self):
        self.bridge = subprocess.Popen(
            [self.bin / "octoskin", "view", "--port", "0", "--socket", self.path / "control", *self.view_options],
            stderr=self.log_file("view"), stdout=self.log_file("output"))
        assert wait_for(lambda: ADDRESS.search(self.log("view"))), self.log("view")
        self.port = int(ADDRESS.search(self.log("view"))[1])

    def stop_daemon(self):
        self.daemon.terminate()
        self.daemon.wait(20)

    def memory_kib(self):
        """Memory of the view's process that is its own."""
        status = pathlib.Path(f"/proc/{self.bridge.pid}/status").read_text()
        return int(re.search(r"RssAnon:\s+(\d+)", status)[1])
