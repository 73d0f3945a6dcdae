"""What confirms this package: kernels against differences, known limits, measurements."""
