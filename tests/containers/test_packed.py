# SPDX-License-Identifier: MIT
"""Logs that are compressed, and files that are no logs."""

import bz2
import gzip
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import unittest

from container_case import LOG, Case, needs, there


def zstd(data):
    import zstandard
    return zstandard.ZstdCompressor(level=3, write_checksum=True).compress(data)


def lz4(data):
    import lz4.frame
    return lz4.frame.compress(data, content_checksum=True)


PACKED = {"gz": gzip.compress, "zst": zstd, "lz4": lz4}
MODULES = {"zst": "zstandard", "lz4": "lz4"}


class Compressed(Case):
    def packings(self):
        for ending, pack in PACKED.items():
            if ending in MODULES and not there(MODULES[ending]):
                print(f"skipped: no {MODULES[ending]} here to write .{ending}", file=sys.stderr)
                continue
            yield ending, pack

    def test_a_packed_log_is_the_log(self):
        whole = LOG.read_bytes()
        for ending, pack in self.packings():
            path = self.write(f"run.csv.{ending}", pack(whole))
            self.assert_same(path)
            self.assertEqual(self.identified("-", stdin=path.read_bytes()), self.identified(LOG))
            half = len(whole) // 2
            self.assert_same(self.write(f"two.csv.{ending}", pack(whole[:half]) + pack(whole[half:])))

    def test_filtered_text_is_that_of_the_plain_log(self):
        path = self.write("run.csv.gz", gzip.compress(LOG.read_bytes()))
        method = ("--method", "lowpass,cutoff=13Hz,order=1")
        self.assertEqual(self.run_tool("filter", path, *method).stdout, self.run_tool("filter", LOG, *method).stdout)
        part = ("--from", "1s", "--to", "2s")
        self.assertEqual(self.run_tool("filter", path, *method, *part).stdout, self.run_tool("filter", LOG, *method, *part).stdout)

    def test_dumps_may_be_packed_too(self):
        data = b"".join(struct.pack("<4d", *row) for row in self.rows)
        self.assert_same(self.write("run.bin.gz", gzip.compress(data)), "--format", "raw", "--layout", ",".join(f"f8:{name}" for name in self.names))

    def test_arrays_may_be_packed_too(self):
        self.run_tool("filter", LOG, "--method", "none", "-o", "run.npy", "-q")
        plain = self.folder / "run.npy"
        self.assert_same(self.write("run.npy.gz", gzip.compress(plain.read_bytes())))

    def test_what_is_cut_off_or_damaged_is_said(self):
        for ending, pack in self.packings():
            data = pack(LOG.read_bytes())
            self.assertIn("cut off", self.refusal(self.write(f"cut.{ending}", data[:len(data) * 2 // 3])))
            damaged = bytearray(data)
            damaged[len(data) // 2] ^= 0xff
            self.assertRegex(self.refusal(self.write(f"bad.{ending}", bytes(damaged))), "damaged|cut off|expected")

    def test_what_is_packed_twice_or_otherwise_names_the_program(self):
        self.assertIn("zcat", self.refusal(self.write("two.gz", gzip.compress(gzip.compress(LOG.read_bytes())))))
        self.assertIn("bzcat", self.refusal(self.write("run.bz2", bz2.compress(LOG.read_bytes()))))
        self.assertIn("xzcat", self.refusal(self.write("run.xz", b"\xfd7zXZ\0")))

    def test_a_bomb_stays_small(self):
        path = self.write("bomb.csv.gz", gzip.compress(b"velocity_deg_s,torque_nm\n" + b"90,1.5\n" * 12_000_000))
        self.assertLess(path.stat().st_size, 150_000)
        said = self.refusal(path, "--sample-rate", "1kHz", "--method", "none", "-q", "-o", "out.csv", command="filter")
        self.assertIn("times smaller", said)
        self.assertFalse((self.folder / "out.csv").exists())


class Strangers(Case):
    def test_each_names_the_line_that_converts_it(self):
        for name, magic, word in (("run.mf4", b"MDF     4.10", "asammdf"), ("run.tdms", b"TDSm\x0e\0\0\0", "nptdms"),
                                  ("run.parquet", b"PAR1\x15\0", "duckdb"), ("run.xlsx", b"PK\x03\x04\x14\0", "libreoffice"),
                                  ("run.bag", b"#ROSBAG V2.0\n", "rosbags-convert")):
            self.assertIn(word, self.refusal(self.write(name, magic + bytes(600))))

    def test_a_name_that_a_shell_would_read_is_not_in_the_line(self):
        for name in ("a b.parquet", "it's.parquet", "$(id).parquet", "`id`.parquet"):
            line = self.refusal(self.write(name, b"PAR1\x15\0" + bytes(600))).split("convert it: ")[1]
            self.assertEqual(line, "duckdb -c \"copy (from 'FILE') to 'run.csv' (format csv)\"")

    def converted(self, name):
        """The log as the line of the refusal makes it, in a folder of its own."""
        line = re.search(r"convert (?:it|a workbook): (.*)$", self.refusal(self.folder / name).strip())[1]
        (self.folder / "run.csv").unlink(missing_ok=True)
        done = subprocess.run(line, shell=True, cwd=self.folder, capture_output=True, text=True, timeout=180,
                              env=dict(os.environ, HOME=str(self.folder)))
        self.assertEqual(done.returncode, 0, f"{line}: {done.stderr}")
        return json.loads(self.run_tool("info", "run.csv", "--json").stdout)

    def assert_has_the_rows(self, got):
        self.assertEqual(got["rows"], len(self.rows))
        self.assertLessEqual({"velocity", "torque"}, {column["role"] for column in got["columns"]})

    @unittest.skipUnless(shutil.which("libreoffice"), "no libreoffice here to write a workbook")
    def test_a_workbook_is_converted_by_its_line(self):
        subprocess.run(["libreoffice", "--headless", "--convert-to", "xlsx", "--outdir", self.folder, LOG], check=True,
                       capture_output=True, timeout=180, env=dict(os.environ, HOME=str(self.folder)))
        (self.folder / f"{LOG.stem}.xlsx").rename(self.folder / "run.xlsx")
        self.assert_has_the_rows(self.converted("run.xlsx"))

    @unittest.skipUnless(shutil.which("duckdb"), "no duckdb here to write Parquet")
    def test_parquet_is_converted_by_its_line(self):
        subprocess.run(["duckdb", "-c", f"copy (from '{LOG}') to 'run.parquet'"], check=True, cwd=self.folder, timeout=60)
        self.assertEqual((self.folder / "run.parquet").read_bytes()[:4], b"PAR1")
        self.assert_has_the_rows(self.converted("run.parquet"))

    @needs("nptdms")
    def test_tdms_is_converted_by_its_line(self):
        import nptdms
        import numpy
        with nptdms.TdmsWriter(str(self.folder / "run.tdms")) as writer:
            writer.write_segment([nptdms.ChannelObject("log", name, numpy.array(values)) for name, values in self.columns.items()])
        self.assert_has_the_rows(self.converted("run.tdms"))

    @needs("asammdf")
    def test_mdf_is_converted_by_its_line(self):
        import asammdf
        import numpy
        times = numpy.array(self.columns["time_s"])
        with asammdf.MDF() as mdf:
            mdf.append([asammdf.Signal(samples=numpy.array(values), timestamps=times, name=name)
                        for name, values in self.columns.items() if name != "time_s"])
            mdf.save(self.folder / "run.mf4")
        self.assert_has_the_rows(self.converted("run.mf4"))
