"""Files: written whole or not at all, and verified whole before anything of them is used.

Every file that the program is given passes `reading`; files of named arrays, npz and HDF5, pass
`members` on top of it: names, sizes, types and values are checked against a table of what such a
file holds.
"""

from sebody.basics.files.writing import check_target, replacing

__all__ = ["check_target", "replacing"]
