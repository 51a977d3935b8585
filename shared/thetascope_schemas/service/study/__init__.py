"""A study: one experiment repeated over what varies, with and without faults, and what is measured in each run."""
