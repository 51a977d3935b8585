"""Operation: log lines, metrics, and whether the service is alive and ready."""
