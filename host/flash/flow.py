"""The steps of `make flash` and `make deploy`, in their order."""

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from . import board, build, hello, image, keep, places, rescue, rom, tools
from .errors import FlashError

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
    settings: bytes | None = None  # robot.json as it was on the board
    survey: board.Survey | None = None


@dataclass(frozen=True)
class Step:
    """One step: `run` does it and returns what came of it, in words; `commands` is what it will call, for --dry-run."""

    title: str
    run: Callable[[Job], str]
    commands: Callable[[Job], list[list[str]]] = lambda job: []


def run(steps: list[Step], job: Job) -> None:
    """Do the steps, saying each. Raises FlashError at the first that fails."""
    for number, step in enumerate(steps, 1):
        print(f"[{number}/{len(steps)}] {step.title}", flush=True)
        print(f"      {step.run(job)}", flush=True)


def rehearse(steps: list[Step], job: Job) -> None:
    """Say the steps and their commands; touch nothing."""
    for number, step in enumerate(steps, 1):
        print(f"[{number}/{len(steps)}] {step.title}")
        for command in step.commands(job):
            print(f"      {tools.shown(command)}")


def _get_image(job: Job) -> str:
    job.image = image.given(job.firmware) if job.firmware else image.fetch(image.PINNED, places.cache_dir())
    return str(job.image)


def _compile(job: Job) -> str:
    job.files = build.build(job.folder, job.sources)
    return f"{len(job.files)} files, {sum(len(file.data) for file in job.files)} bytes"


def _save_settings(job: Job) -> str:
    """Before the erase: over MicroPython if it answers, else out of the raw file system."""
    if job.blank:
        return "not looked for"
    if not hello.ask_prompt(job.port)[0]:
        return _rescue_settings(job)
    return _back_up(job, board.survey(job.port))


def _rescue_settings(job: Job) -> str:
    identity = rom.identity(job.port, job.baud)
    partition = places.backup_dir() / f"files-{identity}-{time.strftime('%Y%m%d-%H%M%S')}.bin"
    if not rescue.read_partition(job.port, partition, job.baud):
        return "a new board: there are none"
    job.settings = rescue.extract(partition, build.SETTINGS)
    partition.unlink()
    return _kept(job.settings, identity)


def _back_up(job: Job, found: board.Survey) -> str:
    if build.SETTINGS in found.files:
        job.settings = board.pull(job.port, build.SETTINGS)
    return _kept(job.settings, found.identity)


def _kept(settings: bytes | None, identity: str) -> str:
    return f"copy in {keep.backup(settings, identity)}" if settings is not None else "the board has none yet"


def _erase(job: Job) -> str:
    tools.show(rom.erase_command(job.port, job.baud))
    return "done"


def _write(job: Job) -> str:
    tools.show(rom.write_command(job.port, job.image, job.baud))
    return "done"


def _wait(job: Job) -> str:
    hello.wait_for_prompt(job.port)
    job.survey = board.survey(job.port)
    return "MicroPython {}.{}.{}, {} bytes free".format(*job.survey.micropython, job.survey.free)


def _find(job: Job) -> str:
    answers, said = hello.ask_prompt(job.port)
    if not answers:
        error = hello.diagnose(said, "MicroPython does not answer")
        raise FlashError(error.what, f"{error.remedy}; a board that never had it needs make flash")
    job.survey = board.survey(job.port)
    saved = _back_up(job, job.survey)
    return "MicroPython {}.{}.{}, {} bytes free; {}: {}".format(*job.survey.micropython, job.survey.free, build.SETTINGS, saved)


def _copy(job: Job) -> str:
    board.check_room(job.files, job.survey)
    changed = [file for file in job.files if job.survey.files.get(file.name) != file.sha256]
    for command in board.copy_commands(job.port, job.files, job.survey.files):
        tools.show(command)
    return f"{len(changed)} of {len(job.files)} files had changed"


def _put_settings(job: Job) -> str:
    """A robot.json on the board stays. Else the one saved before the erase, else the board's latest backup, else the default."""
    default = (job.sources / build.SETTINGS).read_bytes()
    settings, origin = job.settings, "kept"
    if settings is None and (copies := keep.backups(job.survey.identity)):
        # a flash that was broken off after the erase left the board without settings
        settings = copies[0].read_bytes()
        origin = f"restored from {copies[0]} (for the default, remove that file and robot.json on the board)"
    if settings is None:
        settings, origin = default, "the default"
    _put(job, build.SETTINGS, settings)
    doubts = keep.doubts(settings, default)
    return origin + (f", but it {doubts}" if doubts else "")


def _put_key(job: Job) -> str:
    identity, digest = job.survey.identity, job.survey.files.get(KEY_FILE)
    if digest and keep.knows_key(identity, digest):
        return f"known: {places.key_path(identity)}"
    key = board.pull(job.port, KEY_FILE) if digest else keep.new_key()
    path = keep.save_key(key, identity)
    if not digest:
        _put(job, KEY_FILE, key)
    return f"{'learnt from the board' if digest else 'new'}: {path}"


def _put(job: Job, name: str, data: bytes) -> None:
    """Make the board hold one more file, and have it compared with the others."""
    path = job.folder / name
    path.write_bytes(data)
    file = build.BoardFile(name, path)
    for command in board.copy_commands(job.port, [file], job.survey.files):
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
    names = sorted(path.relative_to(job.sources).as_posix() for path in (job.sources / "lib").rglob("*.py"))
    return [build.compile_command(Path("firmware") / name, Path(name).with_suffix(".mpy"), name) for name in names]


def _survey_preview(job: Job) -> list[list[str]]:
    return [tools.mpremote(job.port, "exec", "<list every file with its SHA-256>")]


def _save_preview(job: Job) -> list[list[str]]:
    return [] if job.blank else [*_survey_preview(job), tools.mpremote(job.port, "fs", "cp", f":{build.SETTINGS}", "<backup>")]


def _copy_preview(what: str, name: str) -> Callable[[Job], list[list[str]]]:
    return lambda job: [tools.mpremote(job.port, "fs", "cp", f"<{what}>", f":{name}")]


_SECOND_HALF = [
    Step("copy what changed", _copy, _copy_preview("each changed file", "<its name>")),
    Step("settings (robot.json)", _put_settings, _copy_preview("the kept one, else the default", build.SETTINGS)),
    Step("key of the network link", _put_key, _copy_preview("32 random bytes, if it has none", KEY_FILE)),
    Step("read back and compare", _compare, _survey_preview),
    Step("restart, wait for the firmware's hello", _start),
]

FLASH = [
    Step("stock MicroPython image", _get_image, _fetch_preview),
    Step("compile the firmware", _compile, _compile_preview),
    Step("save the settings on the board (robot.json)", _save_settings, _save_preview),
    Step("erase", _erase, lambda job: [rom.erase_command(job.port, job.baud)]),
    Step("write MicroPython", _write, lambda job: [rom.write_command(job.port, job.firmware or image.PINNED.name, job.baud)]),
    Step("wait for MicroPython", _wait, _survey_preview),
    *_SECOND_HALF,
]

DEPLOY = [
    Step("compile the firmware", _compile, _compile_preview),
    Step("look at the board, save its settings", _find, _save_preview),
    *_SECOND_HALF,
]
