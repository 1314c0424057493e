"""The page and its WebSocket.

The page is served on this computer alone, unless others are let in on purpose. Either way its address carries a random key, without which the
WebSocket refuses: a web page from elsewhere, open in the same browser, must not be able to drive the robot. For the same reason every request
must name this computer by number as its host (a name of somebody else's that leads here is refused: DNS rebinding), and one with an origin
must come from the page itself.

Server to page: JSON lists of messages (`host.link.messages`), gathered for 40 ms. Page to server: JSON {"do": ...} (`Station.command`).
"""

import asyncio
import json
import mimetypes
import secrets
import socket
from pathlib import Path

from microdot import Microdot, Request, Response
from microdot.websocket import WebSocketError, websocket_upgrade

from .station import Station

PAGE = Path(__file__).resolve().parent / "page"
GATHER_S = 0.04
BEHIND = 2000  # messages a page may lag behind before it is let go
POLICY = "default-src 'self'; connect-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:"


class Server:
    """Serves one Station.

    host, port: where; port 0 takes a free one. key: what the address of the page carries.
    """

    def __init__(self, station: Station, host: str = "127.0.0.1", port: int = 0):
        self._station = station
        self._host = host
        self.key = secrets.token_urlsafe(9)
        self._socket = socket.create_server((host, port))
        self.port = self._socket.getsockname()[1]
        self._hosts = {f"{name}:{self.port}" for name in ("127.0.0.1", "localhost", *(_own_addresses() if host == "0.0.0.0" else ()))}
        self._app = Microdot()
        self._app.before_request(self._from_here)
        self._app.route("/")(self._index)
        self._app.route("/live")(self._live)
        self._app.route("/<path:path>")(self._file)

    @property
    def addresses(self) -> list[str]:
        """Where the page can be opened: here first, then from other devices."""
        names = ["127.0.0.1"]
        if self._host == "0.0.0.0":
            names += _own_addresses()
        return [f"http://{name}:{self.port}/?key={self.key}" for name in names]

    async def run(self) -> None:
        """Serve until cancelled."""
        # Microdot opens its own socket by number; this one is taken already, so that a port that is not free shows before anything starts.
        server = await asyncio.start_server(self._serve, sock=self._socket)
        async with server:
            await server.serve_forever()

    async def _serve(self, reader, writer) -> None:
        if not hasattr(writer, "awrite"):
            writer = _Writer(writer)
        try:
            await self._app.handle_request(reader, writer)
        except asyncio.CancelledError:
            pass  # Ctrl-C with a page open: asyncio would print this as an error of the connection

    async def _from_here(self, request: Request):
        """Refuses what did not begin with an address that the monitor printed."""
        host = request.headers.get("Host", "")
        origin = request.headers.get("Origin")
        if host not in self._hosts or origin is not None and origin != f"http://{host}":
            return Response("open the address that the monitor printed; requests by another name or from another page are refused", 403)
        return None

    async def _index(self, request: Request):
        return self._give("index.html")

    async def _file(self, request: Request, path: str):
        return self._give(path)

    def _give(self, name: str):
        path = (PAGE / name).resolve()
        if PAGE not in path.parents or not path.is_file():
            return Response("there is no such page", 404)
        kind = mimetypes.guess_type(path.name)[0] or "application/octet-stream"
        if path.suffix == ".js":
            kind = "text/javascript"  # some systems' tables say otherwise, and browsers then refuse the module
        headers = {"Content-Type": kind + "; charset=utf-8", "Cache-Control": "no-store", "Content-Security-Policy": POLICY}
        return Response(path.read_bytes(), headers=headers)

    async def _live(self, request: Request):
        if not secrets.compare_digest(request.args.get("key", "").encode(), self.key.encode()):
            return Response("open the address that the monitor printed: its key is missing here", 403)
        page = await websocket_upgrade(request)
        await _Visit(page, self._station).run()
        return ""


class _Visit:
    """One open page."""

    def __init__(self, page, station: Station):
        self._page = page
        self._station = station
        self._waiting: list = []
        self._drives = False
        self._loop = asyncio.get_running_loop()

    async def run(self) -> None:
        self._station.listen(self._hear)
        sender = asyncio.create_task(self._send())
        try:
            while True:
                await self._obey(await self._page.receive())
        except (WebSocketError, OSError, asyncio.IncompleteReadError):
            pass  # the page was closed, or its network is gone
        finally:
            sender.cancel()
            self._station.listeners.remove(self._hear)
            if self._drives:
                # The firmware would stop by itself; no need to let it come to that.
                await self._loop.run_in_executor(None, _quietly, self._station.command, {"do": "drive", "what": "stop"})

    def _hear(self, message: dict) -> None:
        """From another thread."""
        self._loop.call_soon_threadsafe(self._waiting.append, message)

    async def _send(self) -> None:
        while True:
            await asyncio.sleep(GATHER_S)
            if len(self._waiting) > BEHIND:
                del self._waiting[: -BEHIND // 2]
            if self._waiting:
                batch, self._waiting[:] = self._waiting[:], []
                await self._page.send(json.dumps(batch))

    async def _obey(self, text) -> None:
        what = None
        try:
            what = json.loads(text)
            if not isinstance(what, dict):
                raise ValueError("no command: a JSON object is needed")
            if what.get("do") == "drive":
                self._drives = what.get("what") == "manual"
            if what.get("do") == "ping":
                self._waiting.append({"type": "pong", "stamp": what.get("stamp")})
                return
            answer = await self._loop.run_in_executor(None, self._station.command, what)
            if answer is not None:
                self._waiting.append(answer)
        except (ValueError, AttributeError, OverflowError, RecursionError) as error:
            self._waiting.append({"type": "refused", "do": what.get("do") if isinstance(what, dict) else None, "text": str(error)})


class _Writer:
    """A StreamWriter with the method Microdot writes through."""

    def __init__(self, writer):
        self._writer = writer

    def __getattr__(self, name):
        return getattr(self._writer, name)

    async def awrite(self, data):
        self._writer.write(data)
        await self._writer.drain()

    async def aclose(self):
        self._writer.close()
        await self._writer.wait_closed()


def _quietly(call, *arguments) -> None:
    try:
        call(*arguments)
    except ValueError:
        pass


def _own_addresses() -> list[str]:
    """IPv4 addresses of this computer in its networks."""
    found = {str(info[4][0]) for info in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)}
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.connect(("192.0.2.1", 9))  # sends nothing; the system only chooses the interface it would use
            found.add(probe.getsockname()[0])
    except OSError:
        pass
    return sorted(name for name in found if not name.startswith("127."))
