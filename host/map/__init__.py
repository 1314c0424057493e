"""Maps of houses for the board: `python -m host.map --help`."""
