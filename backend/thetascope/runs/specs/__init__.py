"""From a request, a file or a library id to the spec that determines the numbers, or a refusal."""
