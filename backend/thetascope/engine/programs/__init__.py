"""Programs of plants and observers: creation, cache, and evaluation."""
