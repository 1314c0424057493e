"""The steps of `make flash` and `make deploy`, in their order."""

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from host.boards import build, places
from host.boards.errors import FlashError
from host.budget import fit

from . import arm, board, hello, image, keep, rescue, rom, tools
from .chip import Chip, check_pins, remarks

_DEFAULT = "the default"  # where a robot.json comes from
KEY_FILE = "network.key"  # firmware/lib/link/auth.py


@dataclass
class Job:
    """What was asked for, and what the steps found out so far."""

    port: str
    firmware: Path | None = None  # the user's own image; None: the pinned one
    baud: int = 460800
    blank: bool = False  # do not look for settings on the board
    sources: Path = build.FIRMWARE
    folder: Path = field(default_factory=lambda: Path(tempfile.mkdtemp(prefix="gapseeker-")))
    image: Path | None = None
    files: list[build.BoardFile] = field(default_factory=list)
    identity: str = ""  # unique number of the chip, hex
    chip: Chip = field(default_factory=lambda: Chip("ESP32"))
    settings: bytes | None = None  # robot.json as it was on the board
    chosen: bytes = b""  # robot.json as it will be there
    origin: str = ""  # where that comes from, in words
    arm: bytes | None = None  # arm.json, the person's or the board's own; None: no arm
    found: board.Survey | None = None
    fits: Callable[[bytes, Path], str] | None = None  # says in words what is left of the board's memory, or raises fit.DoesNotFit; None: fit.check

    @property
    def survey(self) -> board.Survey:
        """What was found on the board; a step before has looked."""
        assert self.found is not None
        return self.found


@dataclass(frozen=True)
class Step:
    """One step: `run` does it and returns what came of it, in words. For --dry-run: `commands` is what it will call, `check` what can be
    found out without the board."""

    title: str
    run: Callable[[Job], str]
    commands: Callable[[Job], list[list[str]]] = lambda job: []
    check: Callable[[Job], str] | None = None


def run(steps: list[Step], job: Job) -> None:
    """Do the steps, saying each. Raises FlashError at the first that fails."""
    for number, step in enumerate(steps, 1):
        print(f"[{number}/{len(steps)}] {step.title}", flush=True)
        print(f"      {step.run(job)}", flush=True)


def rehearse(steps: list[Step], job: Job) -> None:
    """Say the steps and their commands, and make the checks that need no board; touch nothing. Raises FlashError like `run`."""
    for number, step in enumerate(steps, 1):
        print(f"[{number}/{len(steps)}] {step.title}", flush=True)
        if step.check:
            print(f"      {step.check(job)}", flush=True)
        for command in step.commands(job):
            print(f"      {tools.shown(command)}")


def _get_image(job: Job) -> str:
    job.image = image.given(job.firmware) if job.firmware else image.fetch(image.PINNED, places.cache_dir())
    return str(job.image)


def _check_image(job: Job) -> str:
    if not job.firmware:
        return f"{image.PINNED.name}, checked by its SHA-256 when it is fetched"
    job.image = image.given(job.firmware)
    return f"{job.image} is an image for the ESP32"


def _compile(job: Job) -> str:
    job.files = build.build(job.folder, job.sources)
    return f"{len(job.files)} files, {sum(len(file.data) for file in job.files)} bytes"


def _look_at_chip(job: Job) -> str:
    job.identity, job.chip = rom.identify(job.port, job.baud)
    return f"{job.chip.name}, {job.identity}"


def _check_settings(job: Job) -> str:
    """Decide which robot.json the board gets, refuse it before anything is written if the board cannot run it, and make its tables."""
    _choose_settings(job)
    check_pins(job.chip, job.chosen)
    said = [job.origin, *remarks(job.chip, job.chosen)]
    if doubts := keep.doubts(job.chosen, (job.sources / build.SETTINGS).read_bytes()):
        if job.origin == _DEFAULT:
            raise FlashError(f"{job.sources / build.SETTINGS} {doubts}", "correct it, then run this again")
        said.append(f"but it {doubts}")
    if job.arm is not None:
        said.append("arm: " + arm.check(job.arm, job.chosen))
    said.append(_check_memory(job))
    if tables := build.put_tables(job.chosen, job.folder):
        job.files.append(tables)
    return "; ".join(said)


def _choose_settings(job: Job) -> None:
    """A robot.json on the board stays. Else the one saved before the erase, else the board's latest backup, else the default."""
    if job.settings is not None:
        job.chosen, job.origin = job.settings, "the board's own is kept"
    elif job.identity and (copies := keep.backups(job.identity)):
        # a flash that was broken off after the erase left the board without settings
        job.chosen = copies[0].read_bytes()
        job.origin = f"restored from {copies[0]} (for the default, remove that file and robot.json on the board)"
    else:
        job.chosen, job.origin = (job.sources / build.SETTINGS).read_bytes(), _DEFAULT


def _check_memory(job: Job) -> str:
    if job.chip.has_large_heap:
        return f"MicroPython has {job.chip.heap // 1024} KiB of heap here (PSRAM): everything fits"
    if job.found is None and job.image and image.uses_psram(job.image):
        return "the image uses PSRAM: whether there is any shows when it runs"
    try:
        return (job.fits or fit.check)(job.chosen, job.sources)
    except fit.DoesNotFit as error:
        raise FlashError(str(error), error.remedy) from None


def _save_settings(job: Job) -> str:
    """Before the erase: over MicroPython if it answers, else out of the raw file system."""
    if job.blank:
        return "not looked for"
    if not hello.ask_prompt(job.port)[0]:
        return _rescue_settings(job)
    return _back_up(job, board.survey(job.port))


def _rescue_settings(job: Job) -> str:
    partition = places.backup_dir() / f"files-{job.identity}-{time.strftime('%Y%m%d-%H%M%S')}.bin"
    if not rescue.read_partition(job.port, partition, job.baud):
        return "a new board: there are none"
    job.settings = rescue.extract(partition, build.SETTINGS)
    if job.arm is None:
        job.arm = rescue.extract(partition, arm.FILE)
    partition.unlink()
    return _kept(job.settings, job.identity)


def _back_up(job: Job, found: board.Survey) -> str:
    if build.SETTINGS in found.files:
        job.settings = board.pull(job.port, build.SETTINGS)
    if job.arm is None and arm.FILE in found.files:
        job.arm = board.pull(job.port, arm.FILE)
    return _kept(job.settings, found.identity)


def _kept(settings: bytes | None, identity: str) -> str:
    return f"copy in {keep.backup(settings, identity)}" if settings is not None else "the board has none yet"


def _erase(job: Job) -> str:
    tools.show(rom.erase_command(job.port, job.baud))
    return "done"


def _write(job: Job) -> str:
    assert job.image
    tools.show(rom.write_command(job.port, job.image, job.baud))
    return "done"


def _wait(job: Job) -> str:
    hello.wait_for_prompt(job.port)
    job.found = board.survey(job.port)
    said = "MicroPython {}.{}.{}, {} bytes free".format(*job.survey.micropython, job.survey.free)
    if job.image and image.uses_psram(job.image):  # now it can be told
        job.chip = replace(job.chip, heap=job.survey.heap)
        check_pins(job.chip, job.chosen)
        said += "; " + _check_memory(job)
    return said


def _find(job: Job) -> str:
    answers, said = hello.ask_prompt(job.port)
    if not answers:
        error = hello.diagnose(said, "MicroPython does not answer")
        raise FlashError(error.what, f"{error.remedy}; a board that never had it needs make flash")
    job.found = board.survey(job.port)
    job.identity, job.chip = job.survey.identity, job.survey.chip
    if not job.chip.name.startswith("ESP32") or job.chip.name.startswith(("ESP32S", "ESP32C", "ESP32-S2", "ESP32-S3", "ESP32-C")):
        raise FlashError(f"this board is an {job.chip.name}", tools.OTHER_CHIP)
    saved = _back_up(job, job.survey)
    return "MicroPython {}.{}.{}, {} bytes free; {}: {}".format(*job.survey.micropython, job.survey.free, build.SETTINGS, saved)


def _copy(job: Job) -> str:
    board.check_room(job.files, job.survey)
    changed = [file for file in job.files if job.survey.files.get(file.name) != file.sha256]
    for command in board.clear_commands(job.port, job.files, job.survey) + board.copy_commands(job.port, job.files, job.survey):
        tools.show(command)
    return f"{len(changed)} of {len(job.files)} files had changed"


def _put_settings(job: Job) -> str:
    _put(job, build.SETTINGS, job.chosen)
    return job.origin


def _put_arm(job: Job) -> str:
    if job.arm is None:
        return "none"
    _put(job, arm.FILE, job.arm)
    return "on the board; its trajectories are uploaded anew after an erase"


def _put_key(job: Job) -> str:
    identity, digest = job.survey.identity, job.survey.files.get(KEY_FILE)
    if digest and keep.knows_key(identity, digest):
        return f"known: {places.key_path(identity)}"
    key = board.pull(job.port, KEY_FILE) if digest else b""
    learnt = len(key) == places.KEY_SIZE
    if not learnt:  # an empty or short one could be guessed: neither side takes it
        key = keep.new_key()
    path = keep.save_key(key, identity)
    if not learnt:
        _put(job, KEY_FILE, key)
    return f"{'learnt from the board' if learnt else 'new'}: {path}"


def _put(job: Job, name: str, data: bytes) -> None:
    """Make the board hold one more file, and have it compared with the others."""
    path = job.folder / name
    path.write_bytes(data)
    file = build.BoardFile(name, path)
    for command in board.copy_commands(job.port, [file], job.survey):
        tools.show(command)
    job.files.append(file)


def _compare(job: Job) -> str:
    board.compare(job.files, board.survey(job.port).files)
    return f"{len(job.files)} files are as they should be"


def _start(job: Job) -> str:
    return f"firmware {hello.restart(job.port)} says hello"


def _fetch_preview(job: Job) -> list[list[str]]:
    return [["check", str(job.firmware)]] if job.firmware else [["fetch", image.PINNED.url]]


def _compile_preview(job: Job) -> list[list[str]]:
    """One line: the others differ in the name alone."""
    name = "lib/<name>.py"
    return [build.compile_command(Path("firmware") / name, Path(name).with_suffix(".mpy"), name)]


def _survey_preview(job: Job) -> list[list[str]]:
    return [tools.mpremote(job.port, "exec", "<list every file with its SHA-256>")]


def _save_preview(job: Job) -> list[list[str]]:
    return [] if job.blank else [*_survey_preview(job), tools.mpremote(job.port, "fs", "cp", f":{build.SETTINGS}", "<backup>")]


def _copy_preview(what: str, name: str) -> Callable[[Job], list[list[str]]]:
    return lambda job: [tools.mpremote(job.port, "fs", "cp", f"<{what}>", f":{name}")]


_SECOND_HALF = [
    Step("copy what changed", _copy, _copy_preview("each changed file", "<its name>")),
    Step("settings (robot.json)", _put_settings, _copy_preview("the kept one, else the default", build.SETTINGS)),
    Step("arm (arm.json)", _put_arm),
    Step("key of the network link", _put_key, _copy_preview("32 random bytes, if it has none", KEY_FILE)),
    Step("read back and compare", _compare, _survey_preview),
    Step("restart, wait for the firmware's hello", _start),
]

_CHECK = Step("check robot.json: does it fit the board?", _check_settings, check=_check_settings)
_COMPILE = Step("compile the firmware", _compile, _compile_preview, _compile)

FLASH = [
    Step("stock MicroPython image", _get_image, _fetch_preview, _check_image),
    _COMPILE,
    Step("look at the chip", _look_at_chip, lambda job: [rom.identify_command(job.port, job.baud)]),
    Step("save the settings on the board (robot.json)", _save_settings, _save_preview),
    _CHECK,
    Step("erase", _erase, lambda job: [rom.erase_command(job.port, job.baud)]),
    Step("write MicroPython", _write, lambda job: [rom.write_command(job.port, job.firmware or image.PINNED.name, job.baud)]),
    Step("wait for MicroPython", _wait, _survey_preview),
    *_SECOND_HALF,
]

DEPLOY = [
    _COMPILE,
    Step("look at the board, save its settings", _find, _save_preview),
    _CHECK,
    *_SECOND_HALF,
]
