"""What the page teaches with: questions about an experiment, and the lessons of the course."""
