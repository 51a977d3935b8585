"""LTI 1.3: rooms that are opened and joined from a learning platform, and points that go back to its gradebook.

The platforms are registered in a file; without it there is none of this. What a platform says is believed only as far
as its signature covers it, and requests go to registered addresses only.
"""
