"""Parts that all routes share: bodies, answers, problems, languages, headers, pages."""
