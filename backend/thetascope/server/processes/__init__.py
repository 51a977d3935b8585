"""Live sessions in several processes: a supervisor that starts and watches them, and a router in front of them."""
