"""Texts: refusals as codes with arguments, and prose in several languages. Nothing here needs the other schemas."""
