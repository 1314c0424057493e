"""Switches the radio on, first thing in the start: its memory must be there before the heap grows into it."""

HOST = "robot"


def connect(config):
    """(WLAN, None), or (None, why not): a robot without its radio still drives, stops and speaks over USB."""
    try:
        import network

        return start_radio(config, network), None
    except (ImportError, OSError, RuntimeError, ValueError) as error:
        return None, "no WiFi: %s; look at wifi.ssid and wifi.password (8 characters or more) in robot.json" % error


def start_radio(config, network):
    """Switch WiFi on as a station or an access point and return the WLAN; it joins by itself, without waiting.

    config: wifi_ssid, wifi_password, wifi_access_point (True: be the network instead of joining it).
    The robot is then robot.local for those who ask by mDNS. Raises what the network module raises for
    credentials it does not take.
    """
    network.hostname(HOST)
    if config.wifi_access_point:
        wlan = network.WLAN(network.AP_IF)
        wlan.active(True)
        if config.wifi_password:
            wlan.config(ssid=config.wifi_ssid, key=config.wifi_password, security=network.AUTH_WPA2_PSK)
        else:
            wlan.config(ssid=config.wifi_ssid)
    else:
        wlan = network.WLAN(network.STA_IF)
        wlan.active(True)
        wlan.connect(config.wifi_ssid, config.wifi_password)
    wlan.config(pm=network.WLAN.PM_NONE)  # sleeping between beacons would delay commands by up to half a second
    return wlan
