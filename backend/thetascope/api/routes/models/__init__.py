"""What a plant gives before a run: its equations, and the default gains of observers."""
