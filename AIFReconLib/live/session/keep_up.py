"""Which frames to leave out when they come faster than they can be inserted: evenly, and no more than it takes."""

from __future__ import annotations

LARGEST_STRIDE = 64.0


class KeepUp:
    """Decides frame by frame from how long the frames that wait already will take.

    Parameters
    ----------
    longest_delay : float, s
        Above it frames are left out; ever more while it lasts. Below half of it ever fewer.
    """

    def __init__(self, longest_delay: float = 0.5):
        self._longest_delay = longest_delay
        self._stride = 1.0
        self._credit = 0.0

    @property
    def stride(self) -> float:
        """Every how many frames one is taken; 1 when all are."""
        return self._stride

    def admit(self, delay: float) -> bool:
        """Whether to take the next frame.

        Parameters
        ----------
        delay : float, s
            How long the frames that wait will take.
        """
        if delay > self._longest_delay:
            self._stride = min(self._stride * 1.1, LARGEST_STRIDE)
        elif delay < 0.5 * self._longest_delay:
            self._stride = max(self._stride * 0.98, 1.0)
        # Sharing out whole frames by a fraction leaves them evenly spaced
        self._credit += 1.0 / self._stride
        if self._credit < 1.0 - 1e-9 or delay > 4.0 * self._longest_delay:
            self._credit = min(self._credit, 1.0)
            return False
        self._credit -= 1.0
        return True
