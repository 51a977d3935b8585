"""One session without input or output: an experiment advanced row by row, changed, rewound and diagnosed."""
