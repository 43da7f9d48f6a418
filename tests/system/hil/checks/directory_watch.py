"""Waits for a file to be made in a folder, or to get its name there, without asking again and again (inotify(7))."""
import ctypes
import os
import select
import struct
import time

IN_CREATE, IN_MOVED_TO = 0x100, 0x80
LIBC = ctypes.CDLL(None, use_errno=True)


class Watch:
    """From when it is made."""

    def __init__(self, folder):
        self.descriptor = LIBC.inotify_init1(os.O_CLOEXEC)
        if self.descriptor < 0 or LIBC.inotify_add_watch(self.descriptor, os.fsencode(folder), IN_CREATE | IN_MOVED_TO) < 0:
            raise OSError(ctypes.get_errno(), f"inotify: {folder}")
        self.waiting = []  # names that came, and nobody asked for yet

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.close(self.descriptor)

    def await_file(self, name, seconds):
        """After what was awaited before; TimeoutError if none of that name comes."""
        end = time.monotonic() + seconds
        while name not in self.waiting:
            if time.monotonic() > end:
                raise TimeoutError(f"{name} is not made within {seconds} s")
            self.waiting = self.names(max(0, end - time.monotonic()))
        self.waiting = self.waiting[self.waiting.index(name) + 1:]

    def names(self, seconds):
        if not select.select([self.descriptor], [], [], seconds)[0]:
            return []
        events, names, place = os.read(self.descriptor, 65536), [], 0
        while place < len(events):  # struct inotify_event: watch, mask, cookie, length of the name behind it
            length = struct.unpack_from("iIII", events, place)[3]
            names.append(os.fsdecode(events[place + 16:place + 16 + length].rstrip(b"\0")))
            place += 16 + length
        return names
