"""What a run yields: histories by name, balances, pictures, files."""
