"""What an observer's file is written with: the draft, defaults, checks."""
