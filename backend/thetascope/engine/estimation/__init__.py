"""Programs of the covariance, the plant's Kalman filter and its hypotheses."""
