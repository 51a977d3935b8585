"""Plant, measurement and observers advanced together, one run or many in lanes."""
