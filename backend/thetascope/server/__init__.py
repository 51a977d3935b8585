"""The service as a process: the ASGI application, and the library's kernels made beside it."""
