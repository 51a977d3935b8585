"""Parts shared by all routes: bodies, answers, problems, languages, headers, pages."""
