"""Fetches Debian's MicroPython for i386 and unpacks it into a folder, with apt's and dpkg's own tools, as any user.

apt gets a configuration, package lists and a cache of its own; the system's are only read: its sources say which mirror to ask.
"""

import os
import platform
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from . import ports

SUITE = "trixie"  # bookworm has no package
PACKAGES = "micropython libc6 libffi8 libgcc-s1 libmbedcrypto16 libmbedtls21 libmbedx509-7".split()
KEYRING = Path("/usr/share/keyrings/debian-archive-keyring.gpg")
LIMIT_S = 300


class CannotFetch(Exception):
    """There is no 32-bit MicroPython to be had here; the message says why, for a person."""


def fetch(home=ports.HOME, sources=Path("/etc/apt")):
    """Unpack the 32-bit MicroPython into the folder `home`; returns its Port. CannotFetch says why that is not possible.

    The folder appears complete or not at all: all is done beside it, tried, and then renamed. sources: where the system keeps its apt sources.
    """
    if platform.system() != "Linux" or platform.machine() not in ("x86_64", "i686", "i386"):
        raise CannotFetch(f"it runs on Linux on x86-64 only, this is {platform.system()} on {platform.machine()}")
    for tool in ("apt-get", "dpkg"):
        if shutil.which(tool) is None:
            raise CannotFetch(f"this system has no {tool} to fetch Debian's package with")
    source = source_line(sources)
    home.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="micropython32-", dir=home.parent) as folder:
        work = Path(folder)
        packages = _download(work, source)
        root = work / "root"
        for package in packages:
            _call(["dpkg", "-x", str(package), str(root)], work, f"{package.name} cannot be unpacked")
        for unused in (root / "usr/share", root / "usr/lib/i386-linux-gnu/gconv", root / "etc"):
            shutil.rmtree(unused, ignore_errors=True)
        port = ports.ask(ports.command32(root))
        if port is None or port.word_bytes != 4:
            raise CannotFetch("it was fetched but does not start here; this kernel may not run 32-bit programs")
        shutil.rmtree(home, ignore_errors=True)
        os.rename(root, home)
    ports.find.cache_clear()
    return ports.find()


def source_line(folder):
    """The line of sources.list for the suite, from the Debian mirror that the system's sources name."""
    files = [folder / "sources.list", *sorted(folder.glob("sources.list.d/*.list")), *sorted(folder.glob("sources.list.d/*.sources"))]
    for file in files:
        if not file.is_file():
            continue
        text = "\n".join(line for line in file.read_text(errors="replace").splitlines() if not line.lstrip().startswith("#"))
        # "deb [options] ADDRESS suite ..." in a .list, "URIs: ADDRESS ..." in a .sources (sources.list(5)).
        for address in re.findall(r"(?<=\s)[a-z+]+:/\S*/debian/?(?=\s|$)", text):
            key = re.search(r"signed-by\s*[=:]\s*(/[^\s\],]+)", text, re.IGNORECASE)
            keyring = key.group(1) if key else str(KEYRING) if KEYRING.is_file() else None
            options = "arch=i386" + (f" signed-by={keyring}" if keyring else "")
            return f"deb [{options}] {address} {SUITE} main\n"
    raise CannotFetch("the system's package sources name no Debian mirror")


def _download(work, source):
    """The packages' files, fetched into the folder."""
    for folder in ("lists/partial", "cache/archives/partial", "packages", "parts", "preferences"):
        (work / folder).mkdir(parents=True)
    (work / "sources.list").write_text(source)
    (work / "status").touch()  # nothing is installed: only what is asked for is looked at
    settings = {
        "Dir::Etc::SourceList": work / "sources.list",
        "Dir::Etc::SourceParts": work / "parts",
        "Dir::Etc::Preferences": work / "none",
        "Dir::Etc::PreferencesParts": work / "preferences",
        "Dir::State::Lists": work / "lists",
        "Dir::State::Status": work / "status",
        "Dir::Cache": work / "cache",
        "APT::Architecture": "amd64",
        "APT::Architectures": "amd64,i386",
        "APT::Sandbox::User": "",  # root's folders are not for another user to write into
        "APT::Update::Error-Mode": "any",
        "Acquire::Languages": "none",
        "Acquire::Retries": "2",
        "Acquire::http::Timeout": "30",
        "Acquire::https::Timeout": "30",
    }
    apt = ["apt-get", "-qq"]
    for name, value in settings.items():
        apt += ["-o", f"{name}={value}"]
    # Lists that the system adds for its own tools (contents, icons) are not ours to fetch.
    apt += ["-o", "Acquire::IndexTargets::deb::Contents-deb::DefaultEnabled=false", "-o", "Acquire::IndexTargets::deb::DEP-11::DefaultEnabled=false"]
    _call([*apt, "update"], work, "Debian's package lists cannot be fetched")
    _call([*apt, "download", *(f"{name}:i386" for name in PACKAGES)], work / "packages", "Debian's packages cannot be fetched")
    packages = sorted((work / "packages").glob("*.deb"))
    if len(packages) != len(PACKAGES):
        raise CannotFetch(f"only {len(packages)} of {len(PACKAGES)} packages came")
    return packages


def _call(command, folder, trouble):
    environment = {**os.environ, "LC_ALL": "C", "DEBIAN_FRONTEND": "noninteractive"}
    try:
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        raise CannotFetch(f"{trouble}: not done after {LIMIT_S} s") from None
    if done.returncode:
        said = [line for line in done.stderr.splitlines() if line.startswith("E:")] or done.stderr.splitlines()
        raise CannotFetch(f"{trouble}: {said[0].removeprefix('E:').strip() if said else f'{command[0]} ended with code {done.returncode}'}")
