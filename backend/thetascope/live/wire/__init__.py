"""What goes over a viewer's connection, and when."""
