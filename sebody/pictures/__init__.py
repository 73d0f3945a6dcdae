"""Plots, films, pages and reports of results."""
