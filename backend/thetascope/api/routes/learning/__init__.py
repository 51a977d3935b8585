"""What the page teaches with: questions about experiments, the lessons of the course, and their judgement."""
