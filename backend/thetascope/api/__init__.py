"""The REST interface under /api: thin routers over the library, the run manager, the exports and the figures."""
