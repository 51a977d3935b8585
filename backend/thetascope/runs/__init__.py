"""Runs: from a spec to a result, in worker threads, with progress, cancellation and a memory."""
