"""One session with its viewers: its clock, its commands, rows computed ahead, frames for all."""
