"""Names of inputs and outputs of a closed loop's program (closed_loop.py), for modules that do not need SymPy."""

SAMPLE = "due.y."  # input, followed by the output's name: 1 where its sensor takes a sample
JUMP = "jump."  # output, followed by a state's name: the state after an instant
