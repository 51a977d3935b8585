"""Tables as text: encodings, dialects of CSV, and the numbers and words in cells."""
