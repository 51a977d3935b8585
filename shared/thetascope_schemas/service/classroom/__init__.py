"""A classroom: what teachers and students send, and what the wall and the phones are sent."""
