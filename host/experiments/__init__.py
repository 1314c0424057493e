"""The papers' experiments, run in the twin: python -m host.experiments [--quick] [--seeds N] [--cluster ADDRESS]

`plan`      which runs there are
`execute`   one run, on this machine or on a worker of a cluster
`planners`  the firmware with its own planner, and with those it is compared with
`store`     what has been run already
`campaign`  runs what is missing on an executor
`tables`, `figures`, `report`   docs/results.md and its pictures
"""
