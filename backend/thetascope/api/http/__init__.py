"""What all routes share: reading bodies, answers, problems, headers, the pages."""
