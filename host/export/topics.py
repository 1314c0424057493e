"""The topics of one MCAP file: registers schemas and channels as they are first used."""

import json

from . import ExportError

try:
    from mcap.writer import Writer
    from mcap_protobuf.schema import register_schema
except ImportError as error:
    raise ExportError(f"{error.name} is not installed: pip install 'gapseeker[export]' (or .venv/bin/pip install -e '.[export]')") from None

# The numbers of the JSON topics, which is what a plot asks for; the unit is their description
_NUMBERS = {
    "decision": {"time": "s", "number": "", "af": "deg", "ar": "deg", "v": "0..180", "window": "", "zone": "", "free": "mm", "took": "ms"},
    "wheels": {"time": "s", "af": "deg", "ar": "deg", "v": "0..180"},
    "health": {"uptime": "s", "heap": "bytes", "worst": "ms", "battery": "V", "lidar_speed": "r/s", "errors": "", "dropped": ""},
}


class Topics:
    """Writes messages into an open binary file; count: how many so far."""

    def __init__(self, file):
        self._writer = Writer(file)
        self._writer.start(library="gapseeker")
        self._channels: dict[str, int] = {}
        self.count = 0

    def describe(self, facts: dict[str, str], attachments: dict[str, bytes]) -> None:
        """What holds for the whole file: metadata `recording`, and attached files by name."""
        self._writer.add_metadata("recording", facts)
        for name, content in attachments.items():
            self._writer.add_attachment(0, 0, name, "application/json", content)

    def write(self, topic: str, moment: float, message) -> None:
        """A protobuf message at `moment` s; its own timestamps are set here."""
        if topic not in self._channels:
            self._channels[topic] = self._writer.register_channel(topic, "protobuf", register_schema(self._writer, type(message)))
        stamp = _nanoseconds(moment)
        if "timestamp" in message.DESCRIPTOR.fields_by_name:
            message.timestamp.FromNanoseconds(stamp)
        for entity in getattr(message, "entities", ()):
            entity.timestamp.FromNanoseconds(stamp)
        self._add(topic, stamp, message.SerializeToString())

    def write_json(self, name: str, moment: float, content: dict) -> None:
        """A JSON message on the topic /name, one of decision, wheels, health."""
        topic = f"/{name}"
        if topic not in self._channels:
            numbers = {key: {"type": "number", "description": unit} for key, unit in _NUMBERS[name].items()}
            schema = json.dumps({"type": "object", "properties": numbers}).encode()
            number = self._writer.register_schema(f"gapseeker.{name}", "jsonschema", schema)
            self._channels[topic] = self._writer.register_channel(topic, "json", number)
        self._add(topic, _nanoseconds(moment), json.dumps(content).encode())

    @property
    def names(self) -> set[str]:
        """Topics that have a message."""
        return set(self._channels)

    def finish(self) -> None:
        """Write the index; the file is complete."""
        self._writer.finish()

    def _add(self, topic, stamp, data):
        self._writer.add_message(self._channels[topic], stamp, data, stamp)
        self.count += 1


def _nanoseconds(moment: float) -> int:
    return round(moment * 1e6) * 1000
