"""Numbers out of results: strengths, closed forms, fits and errors. Nothing here draws."""
