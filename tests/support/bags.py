# SPDX-License-Identifier: MIT
"""A small writer of MCAP files, from the published layout (mcap.dev/spec), of rosbag2's SQLite files, and of messages in CDR
(ROS 2). It shares nothing with the reader under test."""

import sqlite3
import struct
import zlib

MAGIC = b"\x89MCAP0\r\n"
HEADER = "================================================================================\nMSG: std_msgs/Header\n" \
    "builtin_interfaces/Time stamp\nstring frame_id\n" \
    "================================================================================\nMSG: builtin_interfaces/Time\n" \
    "int32 sec\nuint32 nanosec\n"
JOINT_STATE = "# This is a message that holds data to describe the state of a set of torque controlled joints.\n" \
    "std_msgs/Header header\n\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n" + HEADER


class Cdr:
    """Numbers at multiples of their size, counted behind the four bytes that say the byte order."""

    def __init__(self, big_endian=False):
        self.order, self.body = (">" if big_endian else "<"), b""
        self.head = bytes([0, 0 if big_endian else 1, 0, 0])

    def number(self, code, *values):
        if values:
            size = struct.calcsize("=" + code)
            self.body += b"\0" * (-len(self.body) % size) + struct.pack(f"{self.order}{len(values)}{code}", *values)
        return self

    def text(self, value):
        raw = value.encode() + b"\0"
        self.number("I", len(raw))
        self.body += raw
        return self

    def texts(self, values):
        self.number("I", len(values))
        for value in values:
            self.text(value)
        return self

    def numbers(self, code, values):
        return self.number("I", len(values)).number(code, *values)

    def bytes(self):
        return self.head + self.body


def joint_state(stamp_ns, names, position, velocity, effort, big_endian=False, frame="base"):
    cdr = Cdr(big_endian).number("i", stamp_ns // 10**9).number("I", stamp_ns % 10**9).text(frame).texts(names)
    return cdr.numbers("d", position).numbers("d", velocity).numbers("d", effort).bytes()


def packed(data, how):
    if how == "zstd":
        import zstandard
        return zstandard.ZstdCompressor().compress(data)
    if how == "lz4":
        import lz4.frame
        return lz4.frame.compress(data)
    return data


def record(code, content):
    return bytes([code]) + struct.pack("<Q", len(content)) + content


def text(value):
    raw = value if isinstance(value, bytes) else value.encode()
    return struct.pack("<I", len(raw)) + raw


def mcap(channels, messages, chunk_bytes=4096, compression="", crc=True, summary=True, chunked=True):
    """`channels`: (topic, type, schema) or (topic, type, schema, message encoding, schema encoding); `messages`: (channel, ns, bytes)."""
    announced = b""
    for number, channel in enumerate(channels):
        topic, kind, schema, encoding, schema_encoding = (*channel, "cdr", "ros2msg")[:5]
        announced += record(0x03, struct.pack("<H", number + 1) + text(kind) + text(schema_encoding) + text(schema))
        announced += record(0x04, struct.pack("<HH", number, number + 1) + text(topic) + text(encoding) + text(b""))
    out = bytearray(MAGIC + record(0x01, text("ros2") + text("tests")))
    chunk, times, counts = announced, [], {}

    def close():
        nonlocal out, chunk, times
        if not chunk:
            return
        if chunked:
            data = packed(chunk, compression)
            head = struct.pack("<QQQI", min(times, default=0), max(times, default=0), len(chunk), zlib.crc32(chunk) if crc else 0)
            out += record(0x06, head + text(compression) + struct.pack("<Q", len(data)) + data)
        else:
            out += chunk
        chunk, times = b"", []

    for sequence, (channel, ns, data) in enumerate(messages):
        chunk += record(0x05, struct.pack("<HIQQ", channel, sequence, ns, ns) + data)
        times.append(ns)
        counts[channel] = counts.get(channel, 0) + 1
        if len(chunk) >= chunk_bytes:
            close()
    close()
    out += record(0x0f, struct.pack("<I", 0))
    start = len(out) if summary else 0
    if summary:
        pairs = b"".join(struct.pack("<HQ", channel, count) for channel, count in sorted(counts.items()))
        first, last = (messages[0][1], messages[-1][1]) if messages else (0, 0)
        out += announced + record(0x0b, struct.pack("<QHIIIIQQ", len(messages), len(channels), len(channels), 0, 0, 0, first, last)
                                  + text(pairs))
    return bytes(out + record(0x02, struct.pack("<QQI", start, 0, 0)) + MAGIC)


def db3(path, channels, messages, definitions=True):
    bag = sqlite3.connect(path)
    bag.execute("PRAGMA page_size=512")
    bag.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL)")
    bag.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
    if definitions:
        bag.execute("CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT, encoding TEXT, "
                    "encoded_message_definition TEXT, type_description_hash TEXT)")
    for number, (topic, kind, schema, *_) in enumerate(channels):
        bag.execute("INSERT INTO topics VALUES (?, ?, ?, 'cdr')", (number + 1, topic, kind))
        if definitions:
            bag.execute("INSERT INTO message_definitions(topic_type, encoding, encoded_message_definition) VALUES (?, 'ros2msg', ?)",
                        (kind, schema))
    bag.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)",
                    [(channel + 1, ns, data) for channel, ns, data in messages])
    bag.commit()
    bag.close()
