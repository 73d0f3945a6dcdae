"""Factors with row exchanges, where the loop waits for them."""

from sebody.engine.row_exchanges import Exchanges, exchange
from sebody.engine.sparse_lu import ROOM
from sebody.engine.state import FACTORED, PROJECTED, SOLVED, State
from sebody.engine.system import System


class RowExchanges:
    """Serves a loop that waits for a factorization or a solution with row exchanges.

    Attributes
    ----------
    exchanges : Exchanges or None
        The last factors; None before any are needed.
    """

    def __init__(self, system: System, state: State):
        self.system, self.state = system, state
        self.exchanges: Exchanges | None = None

    def serve(self) -> None:
        """Factorize or solve if the loop waits for it, perhaps since an interrupted call."""
        if self.state.control.phase not in (FACTORED, PROJECTED, SOLVED):
            return
        own = self.exchanges or self._room(0)
        while exchange(self.system, self.state, own) == ROOM:
            own = self._room(int(own.kind[1]))
        self.exchanges = own

    def forget(self) -> None:
        """Forget factors: another state was put in place of the one they are of."""
        self.exchanges = None

    def _room(self, entries: int) -> Exchanges:
        return Exchanges.of(self.system.diagonal.size, self.system.rows.size, entries)
