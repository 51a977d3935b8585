"""The scoreboard: benchmark problems of the library with all observers and the detector."""
