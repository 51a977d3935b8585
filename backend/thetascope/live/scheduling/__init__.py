"""All rooms of the service on one event loop: opened, ticked, given slices of time."""
