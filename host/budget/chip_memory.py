"""A model of the ESP32's memory: where each thing that the start asks for comes to lie, or that there is no room for it.

    first      heap     64 KiB                     the heap's first area
    shared     either   110 592, 98 304 with WiFi  what the heap grows into, and machine code once the places of its own are full
    code       code     14 656 (not with WiFi) and 15 320
    small      data     14, 10 and 4 kB            the heap's last growth, UART rings

The heap grows when a collection has left no place: by as much as it has, or by the largest free block if that is less. Machine code is
committed piece by piece, a function at a time, in the order in which modules are loaded; nothing moves afterwards. So whoever comes late finds
what the others have left, and a start that fits may fail in another order.

Figures: the stock image v1.24.0 (docs/memory.md). Rules: MicroPython py/gc.c (gc_try_add_heap), ports/esp32/main.c (esp_native_code_commit).
"""

from dataclasses import dataclass

FIRST_AREA = 64 * 1024
FIRST_FREE = 56_000  # bytes of it for objects: 54 992 are free after boot, the rest is the interpreter's own, which all figures of the heap count
SHARED, SHARED_WIFI = 110_592, 98_304
CODE_ONLY, CODE_ONLY_WIFI = (14_656, 15_320), (15_320,)
SMALL = (14 * 1024, 10 * 1024, 4 * 1024)
ROOM, ROOM_WIFI = 200 * 1024, 163 * 1024  # heap and machine code together, as they could be filled on the chip

_TABLES = 3 / 128  # of an area goes into the collector's tables
_LEAST_GROWTH = 2048  # beyond what is asked for; below it the heap does not grow
_NODE = 4  # in front of each piece of machine code: the list of them
_HEADER = 8  # of a block of the system's memory, the mirrored address of D/IRAM included
_UART_DRIVER = 640
_RADIO_CONNECTED = 4096  # more than when it is switched on
_REFUSES_BELOW = 64  # a free rest smaller than this is nobody's


class NoRoom(Exception):
    """Something did not fit. The text says what, for whom, and who had taken the room."""


@dataclass
class Block:
    """A free stretch of memory. kind: what it can hold ("shared", "code" or "data")."""

    name: str
    kind: str
    size: int
    free: int

    def take(self, count: int) -> None:
        self.free -= count
        if self.free < _REFUSES_BELOW:
            self.free = max(self.free, 0)


@dataclass(frozen=True)
class Place:
    """Where a thing came to lie: `what` of `owner`, `size` bytes, in the block of this name."""

    what: str
    owner: str
    size: int
    block: str


class ChipMemory:
    """The chip's memory after boot, before main.py. Feed it with what the start does, in order; NoRoom tells the first that does not fit."""

    def __init__(self) -> None:
        self.blocks = [Block("the shared block", "shared", SHARED, SHARED)]
        self.blocks += [Block(f"the {size} bytes for code", "code", size, size) for size in CODE_ONLY]
        self.blocks += [Block(f"the block of {size // 1024} kB", "data", size, size) for size in SMALL]
        self.areas = [FIRST_AREA]
        self.places = [Place("heap", "MicroPython", FIRST_AREA, "the first area")]
        self.radio = False
        self.code = 0
        self.live = 0

    @property
    def heap(self) -> int:
        """Bytes for objects in the areas that the heap has now."""
        return FIRST_FREE + sum(_usable(area) for area in self.areas[1:])

    @property
    def heap_left(self) -> int:
        """Bytes that live objects can still grow by: what the heap has free and what it can still claim, within what the chip was seen to hold."""
        more = sum(_usable(block.free) for block in self.blocks if block.kind != "code" and block.free > _LEAST_GROWTH)
        room = (ROOM_WIFI if self.radio else ROOM) - self.code
        return min(self.heap + more, room) - self.live

    @property
    def code_left(self) -> int:
        """Bytes of machine code that still fit, in pieces."""
        return sum(block.free for block in self.blocks if block.kind != "data")

    def add_code(self, owner: str, pieces: list[int]) -> None:
        """A module with these pieces of machine code (bytes) is loaded."""
        for piece in pieces:
            need = (piece + 3 & ~3) + _NODE + _HEADER
            block = self._first("code", need) or self._first("shared", need)
            if block is None:
                raise NoRoom(f"no room for {piece} bytes of machine code of {owner}: {self._who_has_it()}")
            block.take(need)
            self.code += piece
            self.places.append(Place("machine code", owner, need, block.name))

    def use_heap(self, owner: str, live: int, peak: int) -> None:
        """The heap holds `live` bytes now, and had to hold `peak` since the last event; `owner` is what was done meanwhile."""
        self.live = live
        while self.heap < peak:
            largest = max((block for block in self.blocks if block.kind != "code"), key=lambda block: block.free)
            if largest.free < _LEAST_GROWTH:
                raise NoRoom(f"no room for a heap of {peak} bytes, which {owner} needs: it has {self.heap}, and no free block is left to grow into")
            size = min(largest.free, sum(self.areas))
            largest.take(size)
            self.areas.append(size)
            self.places.append(Place("heap", owner, size, largest.name))
        room = ROOM_WIFI if self.radio else ROOM
        if peak + self.code > room:
            raise NoRoom(f"no room for a heap of {peak} bytes, which {owner} needs, beside {self.code} of machine code: the chip holds {room} of both")

    def add_uart(self, owner: str, receive: int, send: int) -> None:
        """A UART is made: its driver and its rings, in bytes."""
        for what, count in (("UART driver", _UART_DRIVER), ("UART ring", receive), ("UART ring", send)):
            if count:
                self._add_data(what, owner, count)

    def switch_radio_on(self) -> None:
        """WiFi is switched on. Only a heap that has not grown, and code that has not been loaded, leave it room."""
        if self.radio:
            return
        code, shared = self._named(f"the {CODE_ONLY[0]} bytes for code"), self._named("the shared block")
        if shared.free < SHARED:
            raise NoRoom(f"no room for the radio: {self._who_has_it()}; it must be switched on before anything is loaded")
        if code.free < code.size:
            raise NoRoom("no room for the radio: machine code was loaded before it; it must be switched on before anything is loaded")
        shared.take(SHARED - SHARED_WIFI)
        code.free = 0
        self.radio = True
        self.places.append(Place("radio", "WiFi", SHARED - SHARED_WIFI + CODE_ONLY[0], "the shared block and a block for code"))

    def connect_radio(self) -> None:
        """WiFi has joined its network."""
        self._add_data("radio", "WiFi connected", _RADIO_CONNECTED)

    def _add_data(self, what: str, owner: str, count: int) -> None:
        fitting = [block for block in self.blocks if block.kind == "data" and block.free >= count + _HEADER]
        block = min(fitting, key=lambda block: block.free) if fitting else self._first("shared", count + _HEADER)
        if block is None:
            raise NoRoom(f"no room for {count} bytes of {what} of {owner}: {self._who_has_it()}")
        block.take(count + _HEADER)
        self.places.append(Place(what, owner, count + _HEADER, block.name))

    def _first(self, kind: str, need: int) -> Block | None:
        return next((block for block in self.blocks if block.kind == kind and block.free >= need), None)

    def _named(self, name: str) -> Block:
        return next(block for block in self.blocks if block.name == name)

    def _who_has_it(self) -> str:
        there = [place for place in self.places if place.block == "the shared block"]
        if there and there[-1].what == "heap":
            return f"the heap had taken the last of the shared block for {there[-1].owner}"
        return f"{self._named('the shared block').free} bytes of the shared block are left, {there[-1].owner if there else 'nobody'} came last"


def _usable(area: int) -> int:
    return int(area * (1 - _TABLES))


def feed(memory: ChipMemory, event: list) -> None:
    """Give the memory one event of a trace (see trace.py). NoRoom if it does not fit."""
    kind, *what = event
    if kind == "code":
        memory.add_code(*what)
    elif kind == "heap":
        memory.use_heap(*what)
    elif kind == "uart":
        memory.add_uart(*what)
    elif what == ["on"]:
        memory.switch_radio_on()
    else:
        memory.connect_radio()


def replay(trace: list[list]) -> ChipMemory:
    """The chip's memory after a start. NoRoom tells what did not fit."""
    memory = ChipMemory()
    for event in trace:
        feed(memory, event)
    return memory
