"""Observers judged by their estimates: errors, tests, comparison."""
