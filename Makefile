# One word for each thing a person does. `make help` lists them.

PYTHON ?= python3
VENV := .venv
RUN := $(VENV)/bin/python
INSTALLED := $(VENV)/.installed
READY := $(VENV)/.ready

.DEFAULT_GOAL := help
.PHONY: help setup demo demo-house demo-arm test lint coverage pythons check-all bench experiments soak mutants flash deploy monitor screenshots budget drawings animation reference site

help:  ## list the words
	@sed -n 's/^\([a-z][a-z-]*\):[^#]*## /\1\t/p' $(MAKEFILE_LIST) | sort | awk -F'\t' '{printf "  make %-12s %s\n", $$1, $$2}'

setup: $(INSTALLED)  ## install what the host needs into .venv (WHEELS=folder takes what lies there)
	@$(RUN) -m host.micropython
	@touch $(READY)
	@echo "Ready. Try: make demo"

$(READY): pyproject.toml
	@$(MAKE) --no-print-directory setup

$(INSTALLED): pyproject.toml
	@command -v $(PYTHON) >/dev/null || { echo "Missing: $(PYTHON). Install Python 3.11 or newer, or say make setup PYTHON=/path/to/python"; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "Missing: Python 3.11 or newer; $(PYTHON) is $$($(PYTHON) -V). Say make setup PYTHON=/path/to/python"; exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || { echo "Missing: Python's venv module (on Debian and Ubuntu: apt install python3-venv)"; exit 1; }
	@$(RUN) -m pip --version >/dev/null 2>&1 || $(PYTHON) -m venv --clear $(VENV)
	@echo "Installing the host's packages into $(VENV)"
	@$(RUN) tools/install.py $(if $(WHEELS),--wheels "$(WHEELS)") '.[test]'
	@touch $@

demo: $(READY)  ## drive the Z course, 550 mm wide, in the digital twin
	@mkdir -p out
	@$(RUN) -m host.twin Z --width 550 --picture out/demo.png

demo-arm: $(READY)  ## plan the paper's reach past three obstacles, play it on the firmware in the twin, draw and animate it
	@$(RUN) -m host.arm demo

demo-house: $(READY)  ## send it through paper C's house, whose door is half closed, to a goal
	@mkdir -p out
	@$(RUN) -m host.twin house --method gap --cruise 99 --seed 1 --picture out/demo-house.png

test: $(READY)  ## run all tests, a file at a time on each core
	@$(RUN) -m pytest -n auto --dist loadfile

lint: $(READY)  ## look over the sources: ruff and mypy
	@$(VENV)/bin/ruff check
	@$(VENV)/bin/ruff format --check
	@$(VENV)/bin/mypy

# The firmware's lines and branches that its tests reach; what may stop the robot is reached whole. The goal layer is driven in the twin, under MicroPython
# (tests/host/test_twin_house.py), where lines are not counted: its floor is to come.
coverage: $(READY)  ## how much of the firmware the tests reach, with its floors
	@$(RUN) -m pytest -q -k "not micropython" tests/firmware --cov --cov-report=
	@$(VENV)/bin/coverage report --omit='firmware/lib/goal/*' --fail-under=95
	@$(VENV)/bin/coverage report --include='firmware/lib/safety/*,firmware/lib/actuation/*,firmware/lib/params/*' --fail-under=100

pythons: $(READY)  ## the tests under every other Python that is at hand
	@$(RUN) tools/try_pythons.py

check-all: lint test coverage pythons  ## all that .ci/run does, and what takes longer: experiments in full, the bench over all courses
	@$(RUN) -m host.budget --check
	@if $(RUN) -c 'import atheris' 2>/dev/null; then $(RUN) -m tests.fuzz all 60; else echo "left out: the fuzzer; to get it: $(VENV)/bin/pip install atheris"; fi
	@$(RUN) -m host.bench --all-courses
	@$(RUN) -m host.experiments

bench: $(READY)  ## measure what the firmware's stages take, here and on the ESP32 (modelled)
	@$(RUN) -m host.bench

experiments: $(READY)  ## run the papers' experiments and write docs/results.md (ARGS=--quick for a taste, --cluster ADDRESS)
	@$(RUN) -m host.experiments $(ARGS)
	@$(RUN) -m host.arm report

soak: $(READY)  ## drive random courses, rooms and faults for hours, and say what came of it (ARGS="--minutes 5", --cluster ADDRESS)
	@$(RUN) -m host.soak $(ARGS)

mutants: $(READY)  ## change what may stop the robot in one place at a time, and see whether a test notices (ARGS=safety/safety.py; an hour in all)
	@$(RUN) tools/mutants.py $(ARGS)

drawings: $(READY)  ## make the drawings of docs/planner.md anew, from a run of the firmware
	@$(RUN) -m host.drawings

animation: $(READY)  ## make the moving picture of the README anew, and that of the screen, from runs of the twin
	@$(RUN) -m host.drawings.animation
	@$(RUN) -m host.drawings.panel

reference: $(READY)  ## write the pages of docs/ anew that are made from the firmware and from robot.json
	@$(RUN) -m host.reference
	@$(RUN) -m host.wiring --docs >/dev/null

# Packages of its own, installed when it is first asked for: nobody needs them to drive.
site: $(READY)  ## make a site of the README and docs/, to be read without a network: out/site/index.html
	@$(RUN) -c 'import material' 2>/dev/null || $(RUN) tools/install.py $(if $(WHEELS),--wheels "$(WHEELS)") '.[site]'
	@$(RUN) -m host.site

budget: $(READY)  ## what the firmware takes of the board's memory, measured, and what is left (ARGS="--option screen.kind=nextion")
	@$(RUN) -m host.budget $(ARGS)

# What host.flash takes: PORT=/dev/ttyUSB0 FIRMWARE=file.bin BAUD=115200 BLANK=1 ARM=arm.json DRY=1
FLASH = $(RUN) -m host.flash $(if $(PORT),--port $(PORT)) $(if $(BAUD),--baud $(BAUD)) $(if $(ARM),--arm "$(ARM)") $(if $(DRY),--dry-run)

flash: $(READY)  ## put MicroPython and the firmware on an ESP32 (PORT=, FIRMWARE=file.bin, BAUD=, BLANK=1, DRY=1)
	@$(FLASH) $(if $(FIRMWARE),--firmware "$(FIRMWARE)") $(if $(BLANK),--blank)

deploy: $(READY)  ## put what changed of the firmware on the board (PORT=, DRY=1)
	@$(FLASH) --deploy

monitor: $(READY)  ## see and drive the robot, or the twin, in the browser (ADDRESS=twin:z?width=550)
	@$(RUN) -m host.monitor $(if $(ADDRESS),"$(ADDRESS)")

screenshots: $(READY)  ## take the pictures in docs/ again (needs chromium and chromium-driver)
	@SCREENSHOTS=$(CURDIR)/docs $(RUN) -m pytest tests/host/test_monitor_page.py tests/host/test_page_looks.py tests/host/test_page_parts.py tests/host/test_page_replay.py
