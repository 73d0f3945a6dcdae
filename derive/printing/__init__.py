"""Targets: text, a pure function of a kernel's statements; one folder each."""
