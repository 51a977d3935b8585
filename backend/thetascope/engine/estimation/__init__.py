"""Programs for the covariance of observers, the plant's Kalman filter and its bank of hypotheses."""
