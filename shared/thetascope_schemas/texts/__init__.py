"""Texts: refusals as codes with arguments, and prose in several languages. It imports no other schemas."""
