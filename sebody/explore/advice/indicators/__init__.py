"""Predictions of errors, each from the recorded reference run alone; nothing here runs."""
