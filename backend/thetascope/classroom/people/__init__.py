"""Students: their codes and tokens, nicknames, and connections."""
