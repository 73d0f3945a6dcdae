"""Readers and writers of files of finite element programs."""
