"""A WebSocket client for tests that sends exactly the headers and bytes that it is given."""
import base64
import json
import os
import socket
import struct

TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10
SUBPROTOCOLS = ("foxglove.sdk.v1", "foxglove.websocket.v1")


def headers(port, host=None, origin=None, subprotocol=SUBPROTOCOLS[0], more=()):
    """The lines of a handshake. `origin`, `subprotocol`: None leaves the line out."""
    lines = ["GET / HTTP/1.1", f"Host: {host or f'127.0.0.1:{port}'}", "Connection: Upgrade", "Upgrade: websocket",
             "Sec-WebSocket-Version: 13", "Sec-WebSocket-Key: " + base64.b64encode(os.urandom(16)).decode(), *more]
    if origin is not None:
        lines.append(f"Origin: {origin}")
    if subprotocol is not None:
        lines.append(f"Sec-WebSocket-Protocol: {subprotocol}")
    return "\r\n".join(lines) + "\r\n\r\n"


def frame(opcode, payload, is_last=True, is_masked=True, length=None):
    """The bytes of a frame. `length`: another one than the payload's, for half frames."""
    size = len(payload) if length is None else length
    mark = 0x80 if is_masked else 0
    short = size if size < 126 else 126 if size < 65536 else 127
    extended = b"" if size < 126 else struct.pack(">H" if size < 65536 else ">Q", size)
    key = os.urandom(4) if is_masked else b""
    if is_masked:
        pad = key * (len(payload) // 4 + 1)
        payload = bytes(a ^ b for a, b in zip(payload, pad)) if len(payload) < 65536 else \
            (int.from_bytes(payload, "big") ^ int.from_bytes(pad[:len(payload)], "big")).to_bytes(len(payload), "big")
    return bytes([(0x80 if is_last else 0) | opcode, mark | short]) + extended + key + payload


class Refused(Exception):
    """The server's HTTP status in place of 101."""

    def __init__(self, status, answer):
        super().__init__(f"HTTP {status}")
        self.status, self.answer = status, answer


class WebSocket:
    """An open connection. `receive_buffer`: of the kernel, in bytes."""

    def __init__(self, port, receive_buffer=None, timeout=10, **handshake):
        self.socket = socket.socket()
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.settimeout(timeout)
        self.socket.connect(("127.0.0.1", port))
        self.file = self.socket.makefile("rb")
        self.socket.sendall(headers(port, **handshake).encode())
        self.answer = self.read_head()
        self.status = int(self.answer[0].split()[1])
        if self.status != 101:
            body = self.file.read()
            self.close()
            raise Refused(self.status, body.decode())
        fields = dict(line.lower().split(": ", 1) for line in self.answer[1:])
        self.subprotocol = fields.get("sec-websocket-protocol")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.file.close()
        self.socket.close()

    def read_head(self):
        lines = []
        while line := self.file.readline().decode().rstrip("\r\n"):
            lines.append(line)
        if not lines:
            raise ConnectionError("closed without an answer")
        return lines

    def send(self, message):
        if isinstance(message, (dict, list)):
            message = json.dumps(message)
        is_text = isinstance(message, str)
        self.socket.sendall(frame(TEXT if is_text else BINARY, message.encode() if is_text else message))

    def receive(self):
        """The next message: a text as JSON, or bytes; None once the server has closed. Answers pings."""
        parts, kind = [], None
        while True:
            head = self.file.read(2)
            if len(head) < 2:
                return None
            size = head[1] & 0x7F
            if size > 125:
                size, = struct.unpack(">H" if size == 126 else ">Q", self.file.read(2 if size == 126 else 8))
            payload, opcode = self.file.read(size), head[0] & 0x0F
            if opcode == PING:
                self.socket.sendall(frame(PONG, payload))
            elif opcode == CLOSE:
                return None
            elif opcode != PONG:
                kind = kind or opcode
                parts.append(payload)
                if head[0] & 0x80:
                    whole = b"".join(parts)
                    return json.loads(whole) if kind == TEXT else whole

    def until(self, condition, count=1000):
        """The first message for which the condition is true."""
        for _ in range(count):
            message = self.receive()
            if message is None:
                raise ConnectionError("closed")
            if condition(message):
                return message
        raise AssertionError("not among the messages")

    def channels(self, wanted):
        """The channels of these topics, as soon as all are there."""
        found = {}
        while not set(wanted) <= set(found):
            advertised = self.until(lambda one: isinstance(one, dict) and one["op"] == "advertise")
            found.update((channel["topic"], channel) for channel in advertised["channels"])
        return found

    def subscribe(self, topics):
        """Subscribes, with numbers from 1 in this order; the channels by topic."""
        found = self.channels(topics)
        self.send({"op": "subscribe", "subscriptions": [{"id": number, "channelId": found[topic]["id"]}
                                                        for number, topic in enumerate(topics, 1)]})
        return found

    def data(self, subscription=None):
        """(subscription, time in ns, payload) of the next message of any, or of one subscription."""
        def is_wanted(message):
            return isinstance(message, bytes) and message[0] == 1 and \
                subscription in (None, struct.unpack_from("<I", message, 1)[0])
        message = self.until(is_wanted)
        return (*struct.unpack_from("<IQ", message, 1), message[13:])
