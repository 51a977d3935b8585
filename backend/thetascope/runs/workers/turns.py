"""A queue with fair turns: clients take turns, whatever number of computations each of them has in it."""

from collections import Counter, OrderedDict, deque
from collections.abc import Callable, Iterator
from typing import Generic, Protocol, TypeVar

from thetascope.runs.workers.computation import Computation


class HasClient(Protocol):
    """Anything that belongs to a client."""

    @property
    def client(self) -> str:
        """Return the client's name."""
        ...


Item = TypeVar("Item", bound=HasClient)


class Turns(Generic[Item]):
    """The items that wait. Those of one client leave in their order; a client that was served goes behind the others.

    Not thread-safe.
    """

    def __init__(self) -> None:
        self._waiting: OrderedDict[str, deque[Item]] = OrderedDict()

    def __len__(self) -> int:
        return sum(len(items) for items in self._waiting.values())

    def __iter__(self) -> Iterator[Item]:
        for items in self._waiting.values():
            yield from items

    def add(self, item: Item) -> None:
        """Add an item behind the others of its client."""
        self._waiting.setdefault(item.client, deque()).append(item)

    def remove(self, item: Item) -> bool:
        """Remove an item; return whether it was waiting."""
        items = self._waiting.get(item.client)
        if items is None or item not in items:
            return False
        items.remove(item)
        if not items:
            del self._waiting[item.client]
        return True

    def next(self, active: Counter[str], most: int) -> Item | None:
        """Take the next item of the client that has waited for its turn longest; None if no client may have one.

        Args:
            active: how many items of each client are under way.
            most: how many a client may have under way.
        """
        client = self._first(lambda name: active[name] < most)
        if client is None:
            return None
        items = self._waiting[client]
        item = items.popleft()
        if items:
            self._waiting.move_to_end(client)
        else:
            del self._waiting[client]
        return item

    def _first(self, allowed: Callable[[str], bool]) -> str | None:
        return next((name for name in self._waiting if allowed(name)), None)


class Lane:
    """The computations that wait in a lane, and how many of each client run in it."""

    def __init__(self) -> None:
        self.waiting: Turns[Computation] = Turns()
        self.active: Counter[str] = Counter()

    def may_take(self, client: str, places: int, most: int) -> bool:
        """Return whether one more of a client may run: all may have `places`, and each of them `most`."""
        return self.active.total() < places and self.active[client] < most
