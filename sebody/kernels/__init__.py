"""Functions that generated code may call; its signature, search and compilation."""
