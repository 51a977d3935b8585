"""The functions of SciPy that this project uses, with the types that they have here.

SciPy has no stubs. What pyright infers from its source is wrong where the type of a result depends on an argument, and
takes a sixth of its time.
"""
