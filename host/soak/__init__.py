"""Random courses, rooms and faults, driven for hours of robot time: what a single run does not show.

    python -m host.soak --minutes 5        goes on where it was left; --hours, --cluster, --check, --help
    make soak ARGS="--minutes 5"

Case k of a campaign is the same on every machine. Each finished one is a line of the store; a contact or a hang leaves a recording beside it.
"""
