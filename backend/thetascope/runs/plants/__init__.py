"""Plants that users write: check their text, say where each error is and how to correct it, and keep versions."""
