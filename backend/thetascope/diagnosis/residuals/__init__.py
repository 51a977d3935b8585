"""The innovations' filter run along rows: forwards, backwards and under hypotheses."""
