"""The routes, one module per resource under /api."""
