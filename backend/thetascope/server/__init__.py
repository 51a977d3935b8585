"""The service as a process: the ASGI application, and a process that compiles the library's kernels in advance."""
