"""Floor plans: read from what people have, as cells, walls and doors, and made into the board's file. What uses them: host/map, host/twin."""
