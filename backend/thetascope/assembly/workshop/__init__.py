"""Facts about a plant for the workshop: an experiment that suits it, a preview, faults that can be told apart."""
