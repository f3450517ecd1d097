"""Field-oriented control at few PWM cycles per electrical revolution: the firmware's own C over numpy, its plant, and the diagnosis.

    iqfoc.functions       the library's functions over arrays, to the bit
    iqfoc.Machine         a motor file's predictions in the firmware's arithmetic
    iqfoc.Observer        angle and speed without a sensor
    iqfoc.Cycle           the control cycle on a plant: PI, deadbeat, six-step
    iqfoc.Recorder        the firmware's recorder on a run, and its serial line; iqfoc.read_stream makes a recording of that
    iqfoc.Pattern         the modulator of optimal pulse patterns
    iqfoc.tune            a current controller with margins; its change detector
    iqfoc.Drive           the firmware against the switching-level plant; Drive.plant() for a controller of one's own
    iqfoc.diagnose        what a recording shows the model to get wrong
    iqfoc.read_log        logs of other programs as recordings
"""

from importlib.metadata import version as _version

from . import functions
from ._host import Error, InputError, MissingFileError
from .cycle import Command, Cycle, Sample
from .diagnosis import Cause, Diagnosis, Errors, Parameter, diagnose
from .drive import Drive, Means, Plant
from .functions import from_float, golden, to_float
from .logs import read_log
from .machine import Machine
from .motor import Motor
from .observer import Observer
from .pattern import Edges, Pattern
from .recorder import Recorder, read_stream
from .recording import Recording
from .tuning import Tune, TunedControl, tune

__version__ = _version("iqfoc")

__all__ = ["Cause", "Command", "Cycle", "Diagnosis", "Drive", "Edges", "Error", "Errors", "InputError", "Machine", "Means", "MissingFileError",
           "Motor", "Observer", "Parameter", "Pattern", "Plant", "Recorder", "Recording",
           "Sample", "Tune", "TunedControl", "diagnose", "from_float",
           "functions", "golden", "read_log", "read_stream", "to_float", "tune"]


def __dir__():
    return __all__
