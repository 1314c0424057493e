"""The 32-bit MicroPython: how it is found, fetched, and done without."""

import os
import platform
import subprocess
import sys
import time

import pytest

from host import micropython
from host.micropython import debian, mpy, ports
from host.micropython.__main__ import main

LISTS = {
    "one line": ("sources.list", "# deb http://no.example/debian sid main\ndeb http://one.example/debian bookworm main\n"),
    "options": ("sources.list", "deb [arch=amd64 signed-by=/keys/a.gpg] https://two.example/debian/ stable main contrib\n"),
    "deb822": ("sources.list.d/debian.sources", "Types: deb\n# a remark\nURIs: http://three.example/debian\nSuites: trixie\nSigned-By: /keys/b.gpg\n"),
    "a list besides": ("sources.list.d/more.list", "deb http://four.example/debian sid main\n"),
}
FOUND = {
    "one line": ("http://one.example/debian", None),
    "options": ("https://two.example/debian/", "/keys/a.gpg"),
    "deb822": ("http://three.example/debian", "/keys/b.gpg"),
    "a list besides": ("http://four.example/debian", None),
}

on_x86 = pytest.mark.skipif(platform.system() != "Linux" or platform.machine() != "x86_64", reason="needs Linux on x86-64")


@pytest.fixture
def sources(tmp_path):
    """sources(name, text): a folder like /etc/apt with one file."""

    def write(name, text):
        path = tmp_path / "apt" / name
        path.parent.mkdir(parents=True)
        path.write_text(text)
        return tmp_path / "apt"

    return write


@pytest.fixture
def tools(tmp_path, monkeypatch):
    """tools(name=script): a search path with these programs before the system's."""

    def make(**scripts):
        folder = tmp_path / "tools"
        folder.mkdir()
        for name, text in scripts.items():
            path = folder / name.replace("_", "-")
            path.write_text("#!/bin/sh\n" + text)
            path.chmod(0o755)
        monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")

    return make


@pytest.mark.parametrize("kind", LISTS)
def test_the_mirror_is_the_one_that_the_system_asks(sources, kind):
    line = debian.source_line(sources(*LISTS[kind]))
    address, keyring = FOUND[kind]
    assert f"] {address} {debian.SUITE} main" in line and "arch=i386" in line
    if keyring:
        assert f"signed-by={keyring}" in line


def test_a_system_without_a_debian_mirror_says_so(sources):
    with pytest.raises(debian.CannotFetch, match="no Debian mirror"):
        debian.source_line(sources("sources.list", "deb http://archive.example/ubuntu noble main\n"))


def test_another_processor_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr(platform, "machine", lambda: "aarch64")
    with pytest.raises(debian.CannotFetch, match="aarch64"):
        debian.fetch(tmp_path / "home")


@on_x86
def test_a_system_without_apt_says_so(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(debian.CannotFetch, match="no apt-get"):
        debian.fetch(tmp_path / "home")


@on_x86
@pytest.mark.parametrize(
    "apt, why",
    (
        ("echo 'E: Temporary failure resolving' >&2; exit 100", "Temporary failure resolving"),
        ('case "$*" in *download*) touch micropython_1_i386.deb;; esac', "only 1 of"),
    ),
    ids=("no network", "half of it"),
)
def test_a_fetch_that_fails_leaves_nothing(tmp_path, sources, tools, apt, why):
    folder = sources(*LISTS["one line"])
    tools(apt_get=apt, dpkg="exit 0")
    home = tmp_path / "venv" / "micropython32"
    with pytest.raises(debian.CannotFetch, match=why):
        debian.fetch(home, folder)
    assert list(home.parent.iterdir()) == []


@on_x86
def test_what_does_not_start_is_not_put_in_place(tmp_path, sources, tools):
    folder = sources(*LISTS["one line"])
    names = " ".join(f"{name}_1_i386.deb" for name in debian.PACKAGES)
    tools(apt_get=f'case "$*" in *download*) touch {names};; esac', dpkg='mkdir -p "$3/usr/bin"')
    with pytest.raises(debian.CannotFetch, match="does not start here"):
        debian.fetch(tmp_path / "micropython32", folder)
    assert not (tmp_path / "micropython32").exists()


def test_without_it_the_64_bit_port_stands_in_and_that_is_said(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(ports, "HOME", tmp_path / "none")

    def fetch():
        raise debian.CannotFetch("this system has no apt-get")

    monkeypatch.setattr(debian, "fetch", fetch)
    assert main([]) == 0
    said = capsys.readouterr().err
    assert "no apt-get" in said and "64-bit" in said and "twice the heap" in said
    assert main(["--required"]) == 1
    ports.find.cache_clear()
    try:
        assert micropython.find().word_bytes == 8
    finally:
        ports.find.cache_clear()


def test_machine_code_is_counted_by_file(tmp_path):
    (tmp_path / "lib").mkdir()
    (tmp_path / "main.py").write_text("import a\n")
    (tmp_path / "lib" / "a.py").write_text("import micropython\n@micropython.viper\ndef f(a: int) -> int:\n    return a + 1\n")
    (tmp_path / "lib" / "b.py").write_text("def f(a):\n    return a + 1\n")
    once = mpy.machine_code_bytes(tmp_path)
    assert list(once) == ["lib/a.py"] and 20 < once["lib/a.py"] < 200
    (tmp_path / "lib" / "b.py").write_text((tmp_path / "lib" / "a.py").read_text().replace("viper", "native"))
    assert list(mpy.machine_code_bytes(tmp_path)) == ["lib/a.py", "lib/b.py"]


def test_a_program_is_ended_by_its_own_computing_and_not_by_the_clock():
    """A second of processor time for one that takes much of the clock's, as on a busy machine, and too little for one that computes for ever."""
    began = time.monotonic()
    assert micropython.run([sys.executable, "-c", "import time; time.sleep(1.5)"], 1).returncode == 0
    assert time.monotonic() - began > 1.4
    with pytest.raises(subprocess.TimeoutExpired):
        micropython.run([sys.executable, "-c", "while True: pass"], 1)
