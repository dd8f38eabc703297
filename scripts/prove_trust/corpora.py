# SPDX-License-Identifier: MIT
"""What the fuzz targets start from: a folder of files for each, made from the repository and by the tool itself."""

import gzip
import json
import pathlib
import sys
import tempfile

from . import documents

QUANTITIES = ["10Nm", "1kHz", "18deg/s", "1.5e3", "-0.25rad", "2 N m", "5ms", "rpm", "1e308kNm", "12rad/s", "100ns", "0.1kg m^2", "1e-320mHz"]
SPECS = ["switching,table=table.json", "fixed,centers=25Hz:50Hz,q=0.25", "lowpass,cutoff=13Hz,order=2", "tracking,bandwidth=2Hz",
         "oscillator,gain=0.1", "none", "ripple,order=1,amplitude_nm=0.8"]
ARMS = {
    0: "<robot name='r'><link name='a'/><link name='b'/><link name='tool'/><joint name='j' type='revolute'><parent link='a'/><child link='b'/>"
       "<origin xyz='0 0 0.3' rpy='0 1.57 0'/><axis xyz='0 0 1'/><limit lower='-1' upper='1'/></joint><joint name='k' type='fixed'>"
       "<parent link='b'/><child link='tool'/></joint></robot>",
    1: "<mujoco><compiler angle='radian' eulerseq='xyz'/><option gravity='0 0 -9.81'/><default><joint axis='0 1 0'/></default><worldbody>"
       "<body name='a' pos='0 0 1' quat='1 0 0 0'><joint name='j' range='-1 1' ref='0.1'/><body name='b' euler='0 1 0'><joint name='k'/></body>"
       "</body></worldbody></mujoco>",
    2: "a_m,alpha_deg,d_m,theta_deg\n0,0,0.333,0\n0.0825,-90,0,0\n",
    3: "joint,a_m,alpha_deg,d_m,theta_deg\na,0,0,0.333,0\nb,0.0825,-90,0,0\n",
    5: "zyyzyz",
}


def put(folder, number, bytes_):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"seed-{number:03d}").write_bytes(bytes_)


def logs(source):
    """Openings of the logs in the repository, and dialects that they have not."""
    for path in [*sorted(source.glob("data/*.csv")), *sorted(source.glob("tests/log/data/*"))]:
        yield path.read_bytes()[:1200]
    head, row = "time_s{d}velocity_deg_s{d}torque_nm{d}note\n", "{t}{d}60{m}5{d}-0{m}25{d}x\n"
    for delimiter, mark in ((",", "."), (";", ","), ("\t", "."), (" ", ".")):
        for line_end in ("\n", "\r\n"):
            text = head.format(d=delimiter) + "".join(row.format(t=f"0{mark}{k:03d}", d=delimiter, m=mark) for k in range(40))
            yield text.replace("\n", line_end).encode()
    rows = "".join(f"0.{k:03d},60,{k % 7}.25\n" for k in range(40))
    yield ("# time velocity torque\n" + rows).encode()
    yield ("\ufefftime;velocity\n" + rows).encode()
    yield ('"time_s","velocity_deg_s","torque_nm"\n' + rows.replace(",60,", ',"60",')).encode()
    yield ("2026-11-22T10:00:00.{:03d}Z,60,1\n" * 3).format(1, 2, 3).encode()
    yield ("index,velocity_deg_s,torque_nm\n" + rows + "# 1,2,3\n\nEOF\n").encode()


def containers(source):
    """(target, bytes): the examples of the laws, and recordings with what the laws' are without: topics, joints, stamps, texts."""
    examples = source / "tests/log/data"
    for target, name in (("npz", "law.npz"), ("mat", "law.mat"), ("hdf5", "law.h5"), ("mcap", "law.mcap"), ("rosbag2", "law.db3"), ("json", "law.jsonl"),
                         ("raw", "law.raw")):
        if (examples / name).exists():
            yield target, (examples / name).read_bytes()
    csv = (examples / "law.csv").read_bytes()
    yield "packed", gzip.compress(csv)
    yield "packed", gzip.compress(csv[:300]) + gzip.compress(csv[300:])
    # Blocks that are stored as they are: nothing here packs by zstd or lz4.
    half = len(csv) // 2
    blocks = [((len(csv) - half) << 3 | 1, csv[half:]), (half << 3, csv[:half])][::-1]
    yield "packed", b"\x28\xb5\x2f\xfd\x00\x00" + b"".join(head.to_bytes(3, "little") + block for head, block in blocks)
    blocks = [(1 << 31 | len(part)).to_bytes(4, "little") + part for part in (csv[:half], csv[half:])]
    yield "packed", b"\x04\x22\x4d\x18\x60\x40\x82" + b"".join(blocks) + bytes(4)
    sys.path.insert(0, str(source / "tests/support"))
    import bags
    joints = ("/joint_states", "sensor_msgs/msg/JointState", bags.JOINT_STATE)
    texts = ("/hello", "std_msgs/msg/String", "string[] data\nstring<=9 more\n")
    states = [bags.joint_state(10**9 + k * 10**6, ["a", "b"], [0.1 * k, 0.2], [1.0, 2.0], [0.5, k % 3]) for k in range(30)]
    messages = [(0, 10**9 + k * 10**6, state) for k, state in enumerate(states)]
    messages.insert(3, (1, 10**9, bags.Cdr().texts(["x", "yy"]).text("z").bytes()))
    # Without checksums: no mutation would get past one.
    yield "mcap", bags.mcap([joints, texts], messages, crc=False)
    yield "mcap", bags.mcap([joints, texts], messages, crc=False, chunked=False, summary=False)
    points = "Point[2] points\nint32[<=5] codes\nbuiltin_interfaces/Time when\n" + "=" * 80 + "\nMSG: a/Point\nfloat64 tau # Nm\nfloat32 dq\n"
    yield "mcap", bags.mcap([("/p", "a/msg/P", points)],
                            [(0, k * 10**6, bags.Cdr().number("d", 1.0).number("f", 2.0).number("d", 1.0).number("f", 2.0)
                              .numbers("i", [1, 2]).number("i", k).number("I", 5).bytes()) for k in range(20)], crc=False)
    named = [(0, 10**9 + k * 10**6, b'{"timestamp": {"sec": 1, "nsec": %d}, "name": ["a"], "effort": [0.5], "x": {"y": -1e3}}' % k) for k in range(9)]
    yield "mcap", bags.mcap([("/named", "a.N", "", "json", "")], named, crc=False)
    with tempfile.TemporaryDirectory() as scratch:
        for definitions in (True, False):
            path = pathlib.Path(scratch) / f"{definitions}.db3"
            bags.db3(path, [joints], messages[:3], definitions)
            yield "rosbag2", path.read_bytes()


def cut(value):
    """A document with two entries of each list, or six numbers, as sections of filters have: nothing that stands in it is missing,
    and it is read sooner."""
    if isinstance(value, dict):
        return {key: cut(one) for key, one in value.items()}
    if not isinstance(value, list):
        return value
    return [cut(one) for one in value[:2 if any(isinstance(one, (dict, list)) for one in value) else 6]]


def make(tool, source, folder):
    """A folder of seeds for each target in `folder`."""
    source, folder = pathlib.Path(source), pathlib.Path(folder)
    for number, bytes_ in enumerate(logs(source)):
        put(folder / "logs", number, bytes([number % 12, number % 50, number % 3]) + bytes_)
    for number, (target, bytes_) in enumerate(containers(source)):
        put(folder / target, number, bytes([0, number % 50]) + bytes_)
    for number, (reader, text) in enumerate(ARMS.items()):
        put(folder / "arms", number, bytes([reader]) + text.encode())
    for number, text in enumerate([*QUANTITIES, *SPECS]):
        # By the first byte: quantities of eleven dimensions, then methods, visible texts, numbers.
        for reader in ([number % 11, 13] if number < len(QUANTITIES) else [11, 12]):
            put(folder / "texts", 20 * number + reader, bytes([reader]) + text.encode())
    with tempfile.TemporaryDirectory() as scratch:
        for number, text in enumerate(documents.make(tool, source, scratch).values()):
            if len(text) < 20000:
                put(folder / "documents", number, json.dumps(cut(json.loads(text)), ensure_ascii=False).encode())
