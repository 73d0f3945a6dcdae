"""Helpers without mechanics, for all folders: errors, checks of input, files, units, words."""
