"""Calls of the loop for what it lacks: factors with row exchanges, readings of sensors.

Whoever runs the loop puts the address of a function with two arguments, the context that is put
beside it and what is asked for, into `System.aid`. It does what is asked for with the system and
the state of the loop, and returns 0. Python's is `sebody.runs.aid`; libraries have one in C.
"""

from sebody.compiler.decorators import compiled
from sebody.engine.calls import call_aid

ADDRESS, CONTEXT = range(2)     # of `System.aid`


@compiled
def aided(system, what):
    """Ask for FACTORS, a SOLUTION or READINGS; False where nobody answers."""
    if system.aid[ADDRESS] == 0:
        return False
    return call_aid(system.aid[ADDRESS], system.aid[CONTEXT], what) == 0
