"""What an input tells about the faults, and one that tells more."""
