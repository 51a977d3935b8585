"""Rounds of hidden faults: what is drawn and computed, the answers, and their outcome."""
