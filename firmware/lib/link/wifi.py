"""Switches the radio on, first thing in the start: its memory must be there before the heap grows into it."""

from time import sleep_ms

HOST = "robot"  # robot.local, for those who ask by mDNS
_ADVICE = "; look at wifi.ssid and wifi.password (8 characters or more) in robot.json"


def connect(config):
    """(WLAN, remark): the one is None where there is no radio to use, the other where all is well. Raises nothing.

    config: wifi_ssid, wifi_password, wifi_access_point (True: be the network instead of joining it).
    A station joins by itself, now or whenever its network is there, without waiting. A robot without its radio still drives, stops and speaks
    over USB.
    """
    wlan = None
    try:
        import network

        network.hostname(HOST)
        wlan = network.WLAN(network.AP_IF if config.wifi_access_point else network.STA_IF)
        wlan.active(True)
        if config.wifi_access_point:
            _open(wlan, config, network)
            remark = None
        else:
            remark = _join(wlan, config)
        wlan.config(pm=network.WLAN.PM_NONE)  # sleeping between beacons would delay commands by up to half a second
        return wlan, remark
    except (ImportError, OSError, RuntimeError, ValueError, TypeError) as error:
        if wlan is not None:
            _switch_off(wlan)
        return None, "no WiFi: %s%s" % (error, _ADVICE)


def _open(wlan, config, network):
    if config.wifi_password:
        wlan.config(ssid=config.wifi_ssid, key=config.wifi_password, security=getattr(network, "AUTH_WPA2_PSK", 3))
    else:
        wlan.config(ssid=config.wifi_ssid, security=0)


def _join(wlan, config):
    """What is to be said about it, or None. A soft reset leaves the radio as it was: joined, or just joining, and then connect() fails."""
    if wlan.isconnected():
        if _network(wlan) in (None, config.wifi_ssid):
            return None
        wlan.disconnect()
    try:
        wlan.connect(config.wifi_ssid, config.wifi_password)
    except OSError:
        wlan.disconnect()
        sleep_ms(100)
        try:
            wlan.connect(config.wifi_ssid, config.wifi_password)
        except OSError as error:
            if not wlan.isconnected():
                return "WiFi does not join now: %s%s, and restart" % (error, _ADVICE)
    return None


def _network(wlan):
    """The name of the network that is joined, None where the port does not tell it."""
    try:
        return wlan.config("ssid")
    except (OSError, ValueError):
        return None


def _switch_off(wlan):
    try:
        wlan.active(False)
    except (OSError, RuntimeError):
        pass
