"""LLVM instructions of single graph operations that take more than a few lines; nothing here knows the graph."""
