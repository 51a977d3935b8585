"""Build the engine's experiment from a spec or from a change of one."""
