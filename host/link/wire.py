"""A robot on a USB serial line."""

import threading

import serial

from .base import Link, LinkError

BAUD = 115200


class WireLink(Link):
    """serial:PORT. Raises LinkError if the port cannot be opened; a robot that is unplugged ends the link."""

    def __init__(self, address: str, port: str):
        super().__init__(address)
        try:
            self._line = serial.Serial()
            self._line.port = port
            self._line.baudrate = BAUD
            self._line.timeout = 0.1
            self._line.write_timeout = 1
            # Both lines low as the port opens, or the usual reset circuit restarts the board.
            self._line.dtr = False
            self._line.rts = False
            self._line.open()
        except (serial.SerialException, OSError) as error:
            raise LinkError(f"cannot open {port}: {error}; is it plugged in, used by another program, and may you use it?") from None
        self._open = True
        threading.Thread(target=self._read, daemon=True).start()
        self.greet()

    def close(self) -> None:
        self._open = False
        self._line.close()

    def _read(self) -> None:
        while self._open:
            try:
                data = self._line.read(max(1, self._line.in_waiting))
            except (serial.SerialException, OSError, TypeError) as error:
                # TypeError: pyserial's way to say that the port was closed while it read
                if self._open:
                    self._end(f"{self._line.port} is gone: {error}; plug it in and connect again")
                return
            if data:
                self._receive(data)

    def _send(self, data: bytes) -> None:
        try:
            self._line.write(data)
        except (serial.SerialException, OSError) as error:
            self._end(f"{self._line.port} takes nothing: {error}; plug it in and connect again")
