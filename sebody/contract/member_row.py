"""Numbers behind the index row of an element that lanes evaluate member by member.

Places in the buffer of all numbers, the same for lanes and for the numbers of one member: first
those of numbers that the element keeps or sets, which are put back, then all others that it reads.
Then `BEHIND` numbers, whose places count from the end of the row.
"""

KERNEL, TABLE, PLACES, KEPT, BEHIND = 4, 3, 2, 1, 4     # address of the kernel for numbers; of the
# table below; how many places there are; how many of them are of numbers that are put back
IN_LANES, ALONE, ENERGIES, RUNNING, ROOM = range(5)     # addresses of both buffers; length of
# `State.energy`; one bit for every member that is evaluated
