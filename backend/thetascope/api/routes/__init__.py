"""One module a resource under /api."""
