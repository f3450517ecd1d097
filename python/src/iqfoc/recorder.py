"""The firmware's recorder on a run, its serial line, and the recording that comes of it."""

from __future__ import annotations

import math
import os
import pathlib
from collections.abc import Sequence

from ._host import Trouble, ffi, lib, path_bytes, text
from .motor import Motor, motor_of
from .recording import Recording

COLUMNS = ("i_a_A", "i_b_A", "i_c_A", "theta_e_rad", "omega_e_rad_s", "u_dc_V", "d_a", "d_b", "d_c")
TRIGGERS = ("now", "status", "rises", "falls")


class Recorder:
    """The recorder of `iqfoc/recorder.h`, armed: `Cycle.run(plant, n, recorder)` gives it each cycle, `stream` is what its line sends.

    columns: by their names in a recording, a run's (at most 16). rows: that its memory holds. decimation: a row every so many cycles.
    trigger: `now`, or one full memory around the moment when a bit of `status` is set (a name of Cycle.state, or ALARM of a TunedControl),
    or when `trigger_column` `rises` or `falls` through `level`; pre_share: of the memory, for rows before that moment.
    octets_per_cycle: of the line in a control cycle; 0: as many as wait. A line that is too slow loses rows, and counts them.

    >>> motor = iqfoc.Motor("data/motors/jarzebowicz2019.toml")
    >>> plant, cycle, recorder = iqfoc.Drive(motor).plant(), iqfoc.Cycle(motor), iqfoc.Recorder(motor)
    >>> plant.set_speed(1000.0)
    >>> cycle.reference(0.0, 5.0)
    >>> rows = cycle.run(plant, 300, recorder)
    >>> recording = iqfoc.read_stream(recorder.stop())
    >>> recording.rows, bool(abs(recording["i_a_A"] - rows["i_a_A"]).max() < 1e-5)
    (300, True)
    """

    def __init__(self, motor: Motor | str | os.PathLike, columns: Sequence[str] = COLUMNS, rows: int = 4096, decimation: int = 1,
                 trigger: str = "now", trigger_column: str | None = None, level: float = 0.0, status: str | Sequence[str] = (),
                 pre_share: float = 0.0, octets_per_cycle: int = 0):
        motor = motor_of(motor)
        columns, status = list(columns), [status] if isinstance(status, str) else list(status)
        numbers = [lib.py_recorder_column(path_bytes(n)) for n in columns]
        if 0 in numbers or not 1 <= len(columns) <= 16:
            wrong = columns[numbers.index(0)] if 0 in numbers else len(columns)
            raise ValueError(f"columns: {wrong!r}; expected 1 to 16 of {', '.join(COLUMNS)}, i_a_mid_A, i_b_mid_A, i_c_mid_A")
        if trigger not in TRIGGERS:
            raise ValueError(f"no trigger {trigger!r}; there are {', '.join(TRIGGERS)}")
        bits = [lib.py_status_bit(path_bytes(s)) for s in status]
        if 0 in bits:
            raise ValueError(f"no status {status[bits.index(0)]!r}; Cycle.state names them")
        if (trigger == "status") != bool(bits):
            raise ValueError("status: expected names with the trigger 'status', and with no other")
        crossing = trigger in ("rises", "falls")
        if (trigger_column in columns) != crossing or (trigger_column is not None and not crossing):
            raise ValueError(f"trigger_column = {trigger_column!r}; expected one of the columns with 'rises' and 'falls', else None")
        for name, x, low, high in (("rows", rows, 2, 10 ** 8), ("decimation", decimation, 1, 2 ** 32 - 1),
                                   ("octets_per_cycle", octets_per_cycle, 0, 2 ** 32 - 1)):
            if not low <= x <= high:
                raise ValueError(f"{name} = {x}; expected {low} to {high}")
        if not 0.0 <= pre_share < 1.0 or not math.isfinite(level):
            raise ValueError(f"pre_share = {pre_share}, level = {level}; expected 0 to below 1, and a number")
        choice = ffi.new("py_recorder_choice *", {
            "columns": len(columns), "column": numbers, "rows": rows, "decimation": decimation, "trigger": TRIGGERS.index(trigger),
            "status_bits": sum(set(bits)), "trigger_column": columns.index(trigger_column) if crossing else 0, "level": level,
            "pre_share": pre_share, "octets_per_cycle": octets_per_cycle})
        trouble = Trouble()
        self.motor = motor
        self._c = ffi.gc(trouble.check(lib.py_recorder_new(motor._c, choice, trouble.c)), lib.py_recorder_free)

    @property
    def stream(self) -> bytes:
        """All octets that the line has sent so far (docs/recorder-format.md); `iqfoc record` reads them too."""
        count = ffi.new("size_t *")
        octets = lib.py_recorder_stream(self._c, count)
        if octets == ffi.NULL and count[0] > 0:
            raise MemoryError("no memory for the recorder's stream")
        return bytes(ffi.buffer(octets, count[0])) if count[0] else b""

    def stop(self) -> bytes:
        """Ends the recording: the rows in memory and the end frame go out; returns the stream."""
        lib.py_recorder_stop(self._c)
        return self.stream

    def arm(self) -> None:
        """Begins again; rows that are not sent yet are dropped. The stream goes on."""
        lib.py_recorder_arm(self._c)

    @property
    def finished(self) -> bool:
        """All rows and the end frame are sent."""
        return lib.py_recorder_finished(self._c)

    @property
    def lost(self) -> int:
        """Rows lost because the line was too slow."""
        return lib.py_recorder_lost(self._c)


def read_stream(stream: bytes | str | os.PathLike, label: str = "stream") -> Recording:
    """The recording of a recorder's stream, as `iqfoc record` makes it: octets, or a file of them. The counts of frames and lost rows are in
    its `notes`; a missing row ends a stretch.

    >>> recorder = iqfoc.Recorder("data/motors/jarzebowicz2019.toml")
    >>> iqfoc.read_stream(recorder.stop())
    Traceback (most recent call last):
    iqfoc._host.InputError: stream: no row received: 2 frames, 0 damaged, 0 lost
    """
    if isinstance(stream, (str, os.PathLike)):
        stream, label = pathlib.Path(stream).read_bytes(), str(stream)
    trouble, note = Trouble(), ffi.new("char[]", 300)
    octets = ffi.from_buffer("uint8_t[]", stream)
    handle = trouble.check(lib.py_recording_stream(path_bytes(label), octets, len(octets), note, 300, trouble.c))
    recording = Recording._from_handle(handle, label)
    recording.notes = [text(note)]
    return recording
