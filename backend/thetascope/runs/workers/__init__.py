"""Computations in worker processes that can be ended, with limits on time, processor time and memory."""
