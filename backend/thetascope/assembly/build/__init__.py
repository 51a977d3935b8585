"""A spec, or a change of one, → the engine's experiment."""
