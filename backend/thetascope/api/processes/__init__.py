"""One of several processes: what came through the router, and what is asked of another process."""
