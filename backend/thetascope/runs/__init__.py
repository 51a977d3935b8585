"""Run specs in worker threads, with progress, cancellation and a cache of recent runs."""
