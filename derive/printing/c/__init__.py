"""Kernels as C99: functions of the same arguments, without anything else to be called."""
