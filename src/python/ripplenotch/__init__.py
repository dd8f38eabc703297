# SPDX-License-Identifier: MIT
"""Torque ripple of harmonic drives in joint logs: find it, design filters for it, filter it, explain it.

    log = ripplenotch.read("run.csv")
    found = ripplenotch.identify(log)
    table = ripplenotch.design(found, speed=(18, 180, 18))
    torque_nm = ripplenotch.filter(log, table=table)

The functions but `read` are the commands of the program `ripplenotch`, run in this process: the same numbers, bit for bit, and the
same messages. Options are keywords, with _ for -: `sample_rate="1kHz"` is `--sample-rate 1kHz`; `ripplenotch.help("filter")` lists those of a
command. How a value is written:

    True, False          a flag, or none             no_header=True
    a number, a text     as in the command           kt=0.12, sample_rate="1kHz"
    a list               separated by commas         orders=[1, 2]
    a tuple              a range, with colons        speed=(18, 180, 18), bands=[(18, 36), (36, 60)]
    a dict               KEY=VALUE                   unit={"velocity": "rad/s"}, scale={"torque": "0.04Nm"}
    a result, a log      a file that holds it        table=table, model={"schema": ...}, validate=other_log

An option that is a word of Python has a _ behind it: `from_="2s"`. Gear ratios have no unit, orders only "200/turn" (of the joint); numbers without one are in the
unit that the help of the option states.

A log is what `read` returns, a path, or arrays: a mapping (a dict, a pandas.DataFrame) or a structured array with time_s [s],
velocity_deg_s [deg/s], torque_nm [Nm] and, where it is known, position_deg [deg], each of shape (n,). Other names are read as those
of a CSV file are, by their units (velocity_rad_s) or by columns= and unit=; columns that are no numbers are left out. Time may be
left out where `sample_rate` is given. Arrays are held in memory as a file of 64-bit floats; results of them name no commands, since
that file goes.

Warnings of the tool are issued as `RipplenotchWarning`; what it refuses is raised as `UsageError`, `DataError` or `FileError`, with
the program's message. Calls release the GIL; those of several threads take turns. Ctrl-C takes effect when a call returns.

The sources are under the MIT licence. The module is linked with FFTW, so as a binary it is under the GPL, version 2 or later
(docs/decisions/0021-licences.md).
"""

from __future__ import annotations

import io
import json
import os
import sys
import warnings
from collections.abc import Mapping
from typing import Any, NamedTuple, Union

import numpy as np

from . import _ripplenotch

__version__ = _ripplenotch.version
__license__ = "GPL-2.0-or-later"  # of the binary; the sources are MIT
__all__ = ["DataError", "Diagnosis", "Error", "FileError", "GearRatio", "Identification", "Inconclusive", "LimitViolated", "Log",
           "Panel", "Recommendation", "Result", "RipplenotchWarning", "Table", "UsageError", "design", "diagnose", "filter", "help",
           "identify", "plot", "read", "recommend", "report", "run"]

_COLUMNS = ("time_s", "velocity_deg_s", "torque_nm", "position_deg")
# Options of several values that stand in the command line once for each.
_REPEATED = {"accept", "method", "motion", "effect", "rule", "scale", "without"}
# Fields that are command lines.
_COMMANDS = {"command", "take_commands", "runner_up_commands", "check"}
# Options of reading that `read` takes, too.
_READING = {"joint", "gear_ratio", "columns", "unit", "scale", "side", "sample_rate", "from_", "to", "format", "delimiter", "decimal",
            "no_header", "skip_lines", "kt", "hold_bad_values", "clock", "layout"}
# Options that name a document of the program, and what the file is called that holds one.
_DOCUMENTS = {"joint_file": "joint.json", "model": "model.json", "residual": "model.json"}


class RipplenotchWarning(UserWarning):
    """What the program says as a warning."""


class Error(Exception):
    """What the program refuses."""


class UsageError(Error, ValueError):
    """The request is wrong: an option, a specification, a design that cannot exist (exit code 2)."""


class DataError(Error, ValueError):
    """A log or a document cannot be used (exit code 3)."""


class FileError(Error, OSError):
    """A file cannot be read (exit code 4)."""


class LimitViolated(Error):
    """A limit that the caller set does not hold: max_delay, min_attenuation (exit code 1).

    result: what the function would have returned; None of `filter`
    """

    result: Result | None = None


class Inconclusive(Error):
    """The log does not settle the question, with require_conclusive (exit code 5).

    result: what the function would have returned
    """

    result: Result | None = None


_ERRORS = {1: LimitViolated, 2: UsageError, 3: DataError, 4: FileError, 5: Inconclusive, 6: MemoryError}


class Log:
    """One joint of a log. `read` makes it.

    path: str                         the file
    joint: str                        its name; "" where the log names none
    joints: list of str               all joints of the file
    time_s: array, shape (n,)         s
    velocity_deg_s: array, (n,)       deg/s, of the joint
    torque_nm: array, (n,)            Nm; A where torque_unit is "A"
    position_deg: array, (n,) or None deg, continuous; None where the log has none that is the joint's
    sample_rate_hz: float             nominal rate
    torque_unit: str                  "Nm", or "A" for a motor current of unknown torque constant
    warnings: list of str             what a person should know before believing the log
    options: str                      the options of a command that force this reading

    The arrays cannot be written to: functions read the file again, with the options it was read with. Changed values are given as
    arrays: `identify({"time_s": log.time_s, "velocity_deg_s": log.velocity_deg_s, "torque_nm": log.torque_nm - known})`.
    """

    def __init__(self, path: str, words: list[str], fields: dict[str, Any]):
        self.path = path
        self._words = words
        self._state = _state(path)
        self.__dict__.update(fields)

    def __len__(self) -> int:
        return len(self.torque_nm)

    def __repr__(self) -> str:
        return f"<ripplenotch.Log {self.path!r} {self.joint!r}: {len(self)} rows at {self.sample_rate_hz:g} Hz>"


class Result:
    """A document of the program. `result["verdict"]` is its field; `to_json()` is its text, which every command takes as a file."""

    def __init__(self, text: str):
        self._text = text
        self._fields = json.loads(text)

    def __getitem__(self, name: str) -> Any:
        return self._fields[name]

    def to_dict(self) -> dict[str, Any]:
        """The document as `--json` prints it, as a dict of its own."""
        return json.loads(self._text)

    def to_json(self) -> str:
        """The bytes that `--json` prints."""
        return self._text

    def __repr__(self) -> str:
        return f"<ripplenotch.{type(self).__name__}: {self._fields.get('verdict', self._fields['schema'])}>"


class GearRatio(NamedTuple):
    """value: motor turns per joint turn, None where nothing supports one; stderr: its standard error; ci95: its 95 % interval."""

    value: float | None
    stderr: float | None
    ci95: tuple[float, float] | None


class Identification(Result):
    """What `identify` found: joint.json. Fields: docs/commands/identify.md."""

    @property
    def verdict(self) -> str:
        """One sentence with numbers."""
        return self["verdict"]

    @property
    def conclusive(self) -> bool:
        """Lines and a ratio were found, or certainly nothing, and nothing speaks against it."""
        return self["conclusive"]

    @property
    def gear_ratio(self) -> GearRatio:
        ratio = self["gear_ratio"]
        return GearRatio(ratio["value"], ratio["stderr"], ratio["ci95"] and tuple(ratio["ci95"]))

    @property
    def lines(self) -> list[dict[str, Any]]:
        """Strongest first: kind, order, order_output, hz, amplitude_nm (zero to peak), phase_deg, snr, ..."""
        return self["lines"]


class Table(Result):
    """A candidate table: table.json, which `filter` takes. Fields: docs/formats/table.md."""

    @property
    def bands(self) -> list[dict[str, Any]]:
        """By speed: speed_from_deg_s, speed_to_deg_s, notches (with sos), dc_delay_ms, settle_ms, ..."""
        return self["bands"]


class Diagnosis(Result):
    """What `diagnose` found. Fields: docs/commands/diagnose.md."""

    @property
    def verdict(self) -> str:
        return self["verdict"]

    @property
    def named(self) -> list[str]:
        """The effects that the model lacked."""
        return self["named"]

    @property
    def model(self) -> dict[str, Any]:
        """The improved model, which `diagnose` takes as `model`."""
        return self["model"]


class Recommendation(Result):
    """What `recommend` advises. Fields: docs/commands/recommend.md."""

    @property
    def verdict(self) -> str:
        return self["verdict"]

    @property
    def method(self) -> str | None:
        """What `filter` takes as `method`; None where no filter is recommended."""
        return self["take"]

    @property
    def methods(self) -> list[dict[str, Any]]:
        """Best first: method, error_nm, ripple_rms_nm, attenuation_db, longest_delay_ms, overshoot_percent, start_ratio, ..."""
        return self["methods"]


class Panel(NamedTuple):
    """One pair of axes of a figure, as `plot` returns it.

    title, x_label, y_label  texts; labels with their units
    x_log, y_log             whether an axis is logarithmic
    curves                   list of (name, x, y): arrays of one shape (n,); a nan breaks the line
    map                      None, or (x_edges, y_edges, cells) of shapes (m+1,), (n+1,), (n, m), as matplotlib's pcolormesh takes them
    """

    title: str
    x_label: str
    y_label: str
    x_log: bool
    y_log: bool
    curves: list[tuple[str, np.ndarray, np.ndarray]]
    map: tuple[np.ndarray, np.ndarray, np.ndarray] | None


AnyLog = Union[Log, str, "os.PathLike[str]", "Mapping[str, Any]", np.ndarray]


def read(path: str | os.PathLike[str], joint: str | int | None = None, *, gear_ratio: float | None = None, **options: Any) -> Log:
    """Reads one joint of a log, of any format that the program reads.

    path        a file; not "-"
    joint       its name or number (docs/commands/README.md); needed where the file holds several
    gear_ratio  motor turns per joint turn, for motion that was measured before the gear
    options     how the log is read, and which rows of it: columns=, unit=, scale=, side=, sample_rate=, from_=, to=, format=,
                delimiter=, decimal=, no_header=, kt=, hold_bad_values=, ... (docs/commands/README.md)

    Warnings are in `Log.warnings`, not issued.
    """
    path = _file(path)
    words = _words({"joint": joint, **options})
    ratio = _words({"gear_ratio": gear_ratio})
    code, message, fields = _ripplenotch.read(path, ratio + words)
    _raise(code, message)
    return Log(path, words, fields)


def identify(logs: AnyLog | list[AnyLog], gear_ratio: float | None = None, **options: Any) -> Identification:
    """Ripple lines and gear ratio of one joint, from one log of it or several.

    logs        a log, or a list of logs that were read with the same options
    gear_ratio  expected ratio, checked against the lines
    options     order_hint=, false_alarm=, require_conclusive=, simulated=, residual=, and how paths and arrays are read
    """
    return _run("identify", list(logs) if isinstance(logs, (list, tuple)) else [logs], {"gear_ratio": gear_ratio, **options}, Identification)


def design(identification: Identification | Mapping[str, Any] | str | os.PathLike[str] | None = None, **options: Any) -> Table:
    """The table of candidate notch filters.

    identification  of `identify`, or a joint.json; None where gear_ratio=, orders= and sample_rate= are given
    options         speed=(from, to, width) in deg/s, or bands=[(from, to), ...], or a goal: min_attenuation="20dB", max_delay="20ms";
                    q=, depth=, hysteresis=, amplitudes=, ...
    """
    return _run("design", [] if identification is None else [identification], options, Table)


def filter(log: AnyLog, method: str | None = None, **options: Any) -> np.ndarray:
    """The filtered torque of one joint, shape (n,): one value for each row of the log, in Nm.

    method   "lowpass,cutoff=13rad/s,order=1", "tracking,q=1", ... (docs/methods); None where a table= is given
    options  table= (of method "switching"), gear_ratio=, orders=, joint_file=, max_delay=, min_attenuation=, and how paths and arrays
             are read
    """
    files = _Files()
    logs = files.logs([log])
    if (table := options.pop("table", None)) is not None:
        if method is not None:
            raise UsageError("read method= and table=, expected one of them; the table of a method is its key, switching,table=")
        method = f"switching,table={files.table(table)}"
    return files.call(["filter", *logs, *files.words({"method": method, **options})], act=_ripplenotch.torque)


def diagnose(log: AnyLog, model: Mapping[str, Any] | str | os.PathLike[str] | None = "auto", **options: Any) -> Diagnosis:
    """Where model and log disagree, which effect is missing, and how far the gap shrinks with it.

    model    "auto": gear ratio and ripple as `identify` finds them in the log; a model.json, or its fields; None with simulated= or arm=
    options  gear_ratio=, validate=, without=[...], accept=[...], simulated=, arm=, smoothing=, and how paths and arrays are read;
             simulated= may be an array of shape (n,), in Nm: the torque of your own simulation at each row of the log. Then the
             model is None unless it is given
    """
    simulated = options.get("simulated")
    if simulated is None or isinstance(simulated, (str, os.PathLike)):
        return _run("diagnose", [log], {"model": model, **options}, Diagnosis)
    model = None if model == "auto" else model
    torque_nm = np.asarray(simulated, dtype=np.float64)
    if _is_arrays(log) or isinstance(log, (str, os.PathLike)):
        source = _structured(log) if _is_arrays(log) else read(log, **{name: value for name, value in options.items() if name in _READING})
    else:
        source = log
    rows = len(source)
    if torque_nm.shape != (rows,):
        raise UsageError(f"simulated: read an array of shape {torque_nm.shape}, expected ({rows},): one value for each row of the log")
    if isinstance(source, np.ndarray) and "time_s" not in source.dtype.names:
        rate = options.get("sample_rate")
        raise UsageError(f"simulated: read arrays without time_s (sample_rate {rate}), expected time_s, too")
    time_s = source["time_s"] if isinstance(source, np.ndarray) else source.time_s
    files = _Files()
    path = files._array("simulated.npy", np.rec.fromarrays([time_s, torque_nm], names="time_s,torque_nm"))
    return _run("diagnose", [log], {"model": model, **options, "simulated": f"log,file={path},column=torque_nm"}, Diagnosis, files)


def recommend(log: AnyLog, **options: Any) -> Recommendation:
    """Which filter a joint needs, with what each method leaves, costs and adds.

    options  gear_ratio=, orders=, max_delay=, min_attenuation=, max_overshoot=, max_start_error=, target=, and how paths and arrays
             are read
    """
    return _run("recommend", [log], options, Recommendation)


def report(logs: AnyLog | list[AnyLog], **options: Any) -> str:
    """One self-contained HTML page about a log, or logs: its text, to be written to a file.

    options  gear_ratio=, and how paths and arrays are read
    """
    files = _Files()
    paths = files.logs(list(logs) if isinstance(logs, (list, tuple)) else [logs])
    return files.call(["report", *paths, *files.words(options)]).decode()


def plot(command: str, *inputs: Any, **options: Any) -> list[Panel]:
    """The figure that a command draws with --plot, as arrays for any program that draws.

    for panel, axes in zip(panels, figure.subplots(len(panels), squeeze=False)[:, 0]):
        for name, x, y in panel.curves:
            axes.plot(x, y, label=name)
    """
    files = _Files()
    drawn = json.loads(files.call([command, *files.logs(inputs), *files.words(options)], act=_ripplenotch.figure))
    return [_panel(one) for one in drawn["panels"]]


def run(command: str, *inputs: Any, **options: Any) -> Result:
    """Any command whose result is JSON: `run("spectrum", log, domain="order")`, `run("spectrum", log, track=True, gear_ratio=100)["joint"]`."""
    return _run(command, list(inputs), options, Result)


def help(command: str) -> str:
    """The help of a command, with its options and their units."""
    return _Files().call([command, "--help"]).decode()


def _label(axis):
    return f"{axis['label']}, {axis['unit']}" if axis["unit"] else axis["label"]


def _values(numbers):
    return np.array([np.nan if one is None else one for one in numbers], dtype=np.float64)


def _panel(drawn):
    heat = drawn["map"]
    if heat is not None:
        x, y = _values(heat["x_edges"]), _values(heat["y_edges"])
        heat = x, y, _values(heat["cells"]).reshape(len(y) - 1, len(x) - 1)
    return Panel(drawn["title"], _label(drawn["x"]), _label(drawn["y"]), *(drawn[axis]["scale"] == "logarithmic" for axis in "xy"),
                 [(one["name"], _values(one["x"]), _values(one["y"])) for one in drawn["curves"]], heat)


def _run(command, inputs, options, kind, files=None):
    files = files or _Files()
    words = [command, *files.logs(inputs), *files.words(options), "--json"]
    text = files.call(words, kind).decode()
    # The commands would name files that are gone.
    result = kind(json.dumps({name: value for name, value in json.loads(text).items() if name not in _COMMANDS}, indent=2) + "\n"
                  if any(map(_is_arrays, inputs)) else text)
    if kind is not Result and "joints" in result._fields:
        names = [str(one["joint"]) for one in result["joints"]]
        raise UsageError(f"read {len(names)} joints ({', '.join(names)}), expected one; say which with joint=, or take "
                         f"ripplenotch.run({command!r}, ...)")
    return result


def _file(path):
    if not isinstance(path, (str, os.PathLike)):
        raise TypeError(f"read {type(path).__name__}, expected a path, a Log, or arrays named {', '.join(_COLUMNS)}")
    path = os.fspath(path)
    if path == "-":
        raise UsageError("-: read standard input, expected the path of a file, which is read several times")
    return path


def _state(path):
    status = os.stat(path)
    return status.st_size, status.st_mtime_ns


def _raise(code, message):
    if code in _ERRORS:
        raise _ERRORS[code](message)
    if code != 0:
        raise RuntimeError(f"internal fault, exit code {code}: {message}")


def _text(value):
    """One value as the command line has it."""
    if isinstance(value, (bool, np.bool_)):
        raise UsageError(f"read {value} within a list, expected numbers or texts")
    if isinstance(value, tuple):
        return ":".join(map(_text, value))
    if isinstance(value, (list, np.ndarray)):
        return ",".join(map(_text, value))
    if isinstance(value, Mapping):
        return ",".join(f"{key}={_text(one)}" for key, one in value.items())
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return os.fspath(value) if isinstance(value, os.PathLike) else str(value)


def _words(options):
    words = []
    for name, value in options.items():
        option = "--" + name.rstrip("_").replace("_", "-")
        if value is None or value is False or isinstance(value, np.bool_) and not value:
            continue
        if isinstance(value, (bool, np.bool_)):
            words.append(option)
        elif name in _REPEATED and isinstance(value, Mapping):
            for key, one in value.items():
                words += [option, f"{key}={_text(one)}"]
        elif name in _REPEATED and isinstance(value, list):
            for one in value:
                words += [option, _text(one)]
        else:
            words += [option, _text(value)]
    return words


def _is_arrays(value):
    if isinstance(value, np.ndarray):
        return value.dtype.names is not None
    if isinstance(value, Result) or not hasattr(value, "keys"):
        return False
    # A document has a schema, texts and lists of fields; a log has columns of one length.
    columns = [np.asarray(value[name]) for name in value.keys()] if "schema" not in value.keys() else []
    return any(column.ndim == 1 and len(column) > 1 and column.dtype.kind in "fiu" for column in columns)


def _outside():
    """How many calls up the caller of this module is."""
    frame, level = sys._getframe(1), 1
    while frame.f_back is not None and frame.f_code.co_filename == __file__:
        frame, level = frame.f_back, level + 1
    return level


def _structured(arrays):
    names = arrays.dtype.names if isinstance(arrays, np.ndarray) else arrays.keys()
    columns = {str(name): np.asarray(arrays[name]) for name in names if arrays[name] is not None}
    columns = {name: column.astype(np.float64) for name, column in columns.items() if column.dtype.kind in "fiub"}
    shapes = {name: column.shape for name, column in columns.items()}
    if any(len(shape) != 1 for shape in shapes.values()) or len(set(shapes.values())) != 1:
        raise UsageError("read arrays of shapes " + ", ".join(f"{name} {shape}" for name, shape in shapes.items()) +
                         ", expected one shape (n,) for all")
    table = np.empty(next(iter(shapes.values())), dtype=[(name, np.float64) for name in columns])
    for name, column in columns.items():
        table[name] = column
    return table


class _Files:
    """What one call of the program reads as files, held in memory under names that no file has."""

    def __init__(self):
        self._held = {}
        self._log_words = []

    def _hold(self, name, content):
        stem, ending = os.path.splitext(name)
        number = 1
        while name in self._held or os.path.exists(name):
            number += 1
            name = f"{stem}{number}{ending}"
        self._held[name] = content
        return name

    def _document(self, name, value):
        return self._hold(name, (value.to_json() if isinstance(value, Result) else json.dumps(value)).encode())

    def _array(self, name, array):
        content = io.BytesIO()
        np.save(content, array)
        return self._hold(name, content.getvalue())

    def logs(self, inputs):
        """The paths of the inputs; what the logs were read with goes before the other options."""
        for one in inputs:
            if isinstance(one, Log):
                self._log_words = one._words
        return [self._path(one) for one in inputs]

    def _path(self, value):
        if (value._words if isinstance(value, Log) else []) != self._log_words:
            raise UsageError("the logs were read with different options, expected the same for all; hand them over as arrays: "
                             "{'time_s': log.time_s, 'velocity_deg_s': log.velocity_deg_s, 'torque_nm': log.torque_nm}")
        if isinstance(value, Log):
            if _state(value.path) != value._state:
                raise FileError(f"{value.path}: the file is another than when it was read; read it again")
            return value.path
        if _is_arrays(value):
            return self._array("arrays.npy", _structured(value))
        if isinstance(value, Identification) or isinstance(value, Mapping) and "gear_ratio" in value:
            return self._document("joint.json", value)
        if isinstance(value, (Result, Mapping)):
            return self._document("result.json", value)
        return _file(value)

    def table(self, value):
        """The path of a table, or of a file that is made of its fields."""
        return self._document("table.json", value) if isinstance(value, (Result, Mapping)) else os.fspath(value)

    def words(self, options):
        """Options as words, with files for what is no text."""
        given = {}
        for name, value in options.items():
            if name in _DOCUMENTS and isinstance(value, (Result, Mapping)):
                value = self._document(_DOCUMENTS[name], value)
            elif isinstance(value, Log) or name == "validate" and _is_arrays(value):
                value = self._path(value)
            given[name] = value
        return self._log_words + _words(given)

    def call(self, words, kind=None, act=_ripplenotch.run):
        """What the command prints. `kind`: of the result that an error with a result has."""
        code, message, out, talk = act(words, self._held)
        said = []
        for line in talk.splitlines():
            line = line.removeprefix("ripplenotch: ").removeprefix(f"ripplenotch {words[0]}: ")
            if line.startswith("warning: "):
                said.append(line.removeprefix("warning: "))
            else:
                message = message or line
        if code == 0:
            for one in said:
                warnings.warn(one, RipplenotchWarning, stacklevel=_outside())
        message = message or "; ".join(said)
        if code in (1, 5) and kind:
            error = _ERRORS[code](message)
            error.result = kind(out.decode())
            error.args = (message or error.result._fields.get("verdict", ""),)
            raise error
        _raise(code, message)
        return out
