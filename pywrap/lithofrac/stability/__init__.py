"""The stability matrix: extremes of the model, each tried, judged and pushed to where it breaks."""
