"""Turn a request, a file or a library id into the spec that determines the numbers, or refuse it."""
