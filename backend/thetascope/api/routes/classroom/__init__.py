"""Classrooms: the teacher's room, the students' seats, and the websockets of both."""
