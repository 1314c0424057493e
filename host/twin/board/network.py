"""Stands for the ESP32 port's `network`: the same objects, refusals and errors, and a network that a test decides about.

As the port: WLAN(interface) is the same object each time; active(True) twice is no error; a station that is joined says so after a soft reset as
well; connect() returns at once and joins by itself later, again after each loss; a wrong password shows in status() only; what the radio
refuses is an OSError. What the port takes outside the heap is told through `tell`.

For a test: `networks` (name: password) are in reach, `joins_after` looks at isconnected() pass before the network is joined, `fails` is the text
of the error that the next active(True) or connect() raises ("WiFi Internal State Error", "WiFi Out of Memory").

Source: MicroPython ports/esp32/network_wlan.c, network_common.c.
"""

from micropython import const

STA_IF = const(0)
AP_IF = const(1)
AUTH_OPEN = const(0)
AUTH_WPA2_PSK = const(3)
STAT_IDLE = const(1000)
STAT_CONNECTING = const(1001)
STAT_GOT_IP = const(1010)
STAT_NO_AP_FOUND = const(201)
STAT_WRONG_PASSWORD = const(202)

networks = {"net": "12345678"}
joins_after = 2
fails = None
tell = None  # tell("radio", "on" or "connected"), of whoever counts the chip's memory

_hostname = "mpy-esp32"
_on = False


class _Wlan:
    IF_STA, IF_AP = STA_IF, AP_IF
    SEC_OPEN, SEC_WPA2 = AUTH_OPEN, AUTH_WPA2_PSK
    PM_NONE, PM_PERFORMANCE, PM_POWERSAVE = 0, 1, 2

    def __init__(self, interface):
        self._interface = interface
        self._active = False
        self._wanted = None
        self._looks = 0
        self._status = STAT_IDLE
        self._settings = {"pm": self.PM_PERFORMANCE}

    def active(self, on=None):
        """Whether the interface is on; switches it."""
        global _on
        if on is None:
            return self._active
        if on:
            _fail()
            if not _on:
                _on = True
                if tell:
                    tell("radio", "on")
        elif self._active:
            self._wanted = None
            self._status = STAT_IDLE
        self._active = bool(on)
        return self._active

    def connect(self, ssid=None, key=None, *, bssid=None):
        """Begin to join; isconnected() and status() tell the rest."""
        if not self._active:
            raise OSError("Wifi Not Started")
        _fail()
        if self._wanted is not None and self._status == STAT_CONNECTING:
            raise OSError("Wifi Internal State Error")  # the driver is still joining
        if key and not 8 <= len(key) <= 64:
            raise OSError("Wifi Invalid Password")
        self._wanted = (ssid, key)
        self._looks = 0
        self._status = STAT_CONNECTING

    def disconnect(self):
        """Leave the network."""
        self._wanted = None
        self._status = STAT_IDLE

    def lose(self):
        """For a test: the network is gone for now; the driver joins again by itself."""
        self._looks = 0
        self._status = STAT_CONNECTING

    def isconnected(self):
        """Whether the network is joined; of an access point, whether somebody is there."""
        if self._interface == AP_IF:
            return self._active
        if self._wanted is None or not self._active:
            return False
        if self._status == STAT_GOT_IP and self._wanted[0] in networks:
            return True
        self._looks += 1
        if self._looks <= joins_after:
            return False
        name, key = self._wanted
        if name not in networks:
            self._status = STAT_NO_AP_FOUND
        elif networks[name] != (key or ""):
            self._status = STAT_WRONG_PASSWORD
        else:
            self._status = STAT_GOT_IP
            if tell:
                tell("radio", "connected")
            return True
        return False

    def status(self, what=None):
        """Code of what it is doing, or the strength of the signal."""
        if what is None:
            return self._status
        if what == "rssi":
            return -50
        if what == "stations":
            return []
        raise ValueError("unknown status param")

    def config(self, name=None, **settings):
        """Read one setting, or change some."""
        if name is not None:
            if name not in self._settings:
                raise ValueError("unknown config param")
            return self._settings[name]
        if not self._active and self._interface == AP_IF:
            raise OSError("Wifi Not Started")
        for one in settings:
            if one not in ("ssid", "key", "security", "channel", "hidden", "max_clients", "pm", "reconnects", "txpower", "mac", "protocol"):
                raise ValueError("unknown config param")
            self._settings[one] = settings[one]

    def ifconfig(self, addresses=None):
        """(address, mask, gateway, name server)."""
        return ("192.168.4.1" if self._interface == AP_IF else "192.168.1.50", "255.255.255.0", "192.168.1.1", "192.168.1.1")

    def ipconfig(self, name=None, **settings):
        """The parts of ifconfig() that are read."""
        address, mask, gateway, _ = self.ifconfig()
        return (address, mask) if name == "addr4" else gateway


_station, _access_point = _Wlan(STA_IF), _Wlan(AP_IF)


class WLAN(_Wlan):
    """WLAN(interface): the station or the access point, always the same object; the port has them in memory of its own as well."""

    def __new__(cls, interface=STA_IF):
        if interface not in (STA_IF, AP_IF):
            raise ValueError("invalid WLAN interface identifier")
        return _access_point if interface else _station


def hostname(name=None):
    """The name in the network."""
    global _hostname
    if name is None:
        return _hostname
    if len(name) > 32:
        raise ValueError("hostname too long")
    _hostname = name


def country(code=None):
    """The country whose channels are used."""
    return "XX"


def _fail():
    global fails
    if fails:
        text, fails = fails, None
        raise OSError(text)
