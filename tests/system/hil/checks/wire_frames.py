"""Frames as docs/protocol.md has them, by that page alone: checksums, and frames of a log changed and sealed again."""

CRC16_TYPES = (0, 1, 3, 5, 7, 9, 12)  # by type: identifier / 64; the others have CRC-8


def crc(data, width, polynomial, start, final):
    value = start
    for byte in data:
        value ^= byte << (width - 8)
        for _ in range(8):
            value = (value << 1 ^ (polynomial if value >> (width - 1) else 0)) & ((1 << width) - 1)
    return value ^ final


def checksum(can_id, length, data):
    covered = can_id.to_bytes(2, "little") + bytes([length]) + data
    if can_id // 64 in CRC16_TYPES:
        return crc(covered, 16, 0x1021, 0xFFFF, 0).to_bytes(2, "big")
    return crc(covered, 8, 0x2F, 0xFF, 0xFF).to_bytes(1, "big")


def parsed(frame):
    """`ID#DATA` of a classical frame, as identifier and bytes."""
    can_id, data = frame.split("#")
    return int(can_id, 16), bytes.fromhex(data)


def is_sealed(frame):
    can_id, data = parsed(frame)
    size = 2 if can_id // 64 in CRC16_TYPES else 1
    return checksum(can_id, len(data), data[:-size]) == data[-size:]


def changed(frame, change):
    """The frame with `change(bytearray)` done to it, and the checksum that belongs to it."""
    can_id, data = parsed(frame)
    size = 2 if can_id // 64 in CRC16_TYPES else 1
    body = bytearray(data[:-size])
    change(body)
    return f"{can_id:03X}#{(bytes(body) + checksum(can_id, len(data), bytes(body))).hex().upper()}"


def of_version(frame, version):
    def change(body):
        body[0] = body[0] & ~7 | version
    return changed(frame, change)


def of_another_board(heartbeat):
    """The same heartbeat with another uid_crc."""
    def change(body):
        body[2] ^= 0xFF
    return changed(heartbeat, change)
