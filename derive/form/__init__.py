"""What a kernel is made of: typed numbers, arrays, functions, steps and statements."""
