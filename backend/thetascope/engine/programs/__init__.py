"""Programs of plants and observers: made once, found again, called."""
