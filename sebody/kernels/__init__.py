"""What generated code may call, and how it is called, found and compiled."""
