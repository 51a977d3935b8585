"""From a System of equations to machine code."""
