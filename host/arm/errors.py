"""What a person gave that cannot be used."""


class ArmError(ValueError):
    """An arm, a scene, a pose or a file that cannot be used; the message is one line that says why, and what to do."""
