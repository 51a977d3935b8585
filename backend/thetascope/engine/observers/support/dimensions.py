"""The dimensions of gains: what a gain is in other units of states, outputs, faults and time follows from them."""

from dataclasses import dataclass

from thetascope.messages import Message


@dataclass(frozen=True)
class Dimension:
    """A product of powers of units.

    The state, output or fault is the one that a row of the gain belongs to. For a gain whose rows belong to something
    else, the output is the plant's only one.

    Attributes:
        words: as users read it; in signs, or an entry of the catalogues if it contains words.
        state, output, fault, time: exponents.
    """

    words: str | Message = ""
    state: float = 0.0
    output: float = 0.0
    fault: float = 0.0
    time: float = 0.0


NUMBER = Dimension()
SECONDS = Dimension("s", time=1)
RATE = Dimension("1/s", time=-1)
RATE_TO_ORDER = Dimension(Message("unit.rate-to-order"), time=-1)
STATE_PER_OUTPUT = Dimension(Message("unit.state-per-output"), state=1, output=-1)
STATE_PER_OUTPUT_SECOND = Dimension(Message("unit.state-per-output-second"), state=1, output=-1, time=-1)
STATE_SQUARED = Dimension(Message("unit.state-squared"), state=2)
STATE_SQUARED_PER_SECOND = Dimension(Message("unit.state-squared-per-second"), state=2, time=-1)
OUTPUT = Dimension(Message("unit.output"), output=1)
OUTPUT_PER_SECOND = Dimension(Message("unit.output-per-second"), output=1, time=-1)
OUTPUT_SQUARED = Dimension(Message("unit.output-squared"), output=2)
OUTPUT_SQUARED_SECONDS = Dimension(Message("unit.output-squared-seconds"), output=2, time=1)
OUTPUT_PER_FAULT_SQUARED_SECONDS = Dimension(
    Message("unit.output-per-fault-squared-seconds"), output=2, fault=-2, time=1
)
FAULT_PER_OUTPUT_SECOND = Dimension(Message("unit.fault-per-output-second"), fault=1, output=-1, time=-1)
FAULT_SQUARED = Dimension(Message("unit.fault-squared"), fault=2)
FAULT_PER_ROOT_SECOND = Dimension(Message("unit.fault-per-root-second"), fault=1, time=-0.5)
FAULT_PER_OUTPUT_SQUARED = Dimension(Message("unit.fault-per-output-squared"), fault=2, output=-2)
FAULT_PER_OUTPUT_SQUARED_SECOND = Dimension(
    Message("unit.fault-per-output-squared-second"), fault=2, output=-2, time=-1
)
