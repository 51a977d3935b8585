"""Classrooms: rooms with a code, students without accounts, rounds, votes and answers. All of it is in memory."""
