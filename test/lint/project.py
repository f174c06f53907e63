# SPDX-License-Identifier: BSD-3-Clause
"""What every check of the lint works with: the files of the project, and findings about them."""

import functools
import hashlib
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

SKIPPED_DIRECTORIES = {".git", "build", "devel", "install", "output", "__pycache__"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


@dataclass(frozen=True)
class Finding:
    """One violation: where, which rule, and what to do about it."""

    path: str
    line: int
    rule: str
    text: str

    def __str__(self):
        return f"{self.path}:{self.line}: [{self.rule}] {self.text}"


class Skipped(Exception):
    """A check that cannot run here, with the reason."""


class Project:
    """The files under `root` that belong to the project, as git sees them, and the build folder."""

    def __init__(self, root, build=None):
        self.root = Path(root).resolve()
        self.build = Path(build).resolve() if build else None

    @functools.cached_property
    def files(self):
        """Paths relative to the root, sorted: tracked, or new and not ignored."""
        listing = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            cwd=self.root, capture_output=True, check=False)
        if listing.returncode == 0:
            names = listing.stdout.decode().split("\0")
        else:  # an archive without .git
            names = [str(path.relative_to(self.root)) for path in self.root.rglob("*")
                     if not SKIPPED_DIRECTORIES & set(path.relative_to(self.root).parts)]
        return sorted({name for name in names if name and (self.root / name).is_file()})

    def matching(self, pattern):
        """Files whose path matches the regular expression from start to end."""
        return [name for name in self.files if re.fullmatch(pattern, name)]

    @functools.lru_cache(maxsize=None)
    def text(self, name):
        return (self.root / name).read_bytes().decode("utf-8", errors="replace")  # keeps CR LF

    def lines(self, name):
        """(number, text) of each line, from 1."""
        return enumerate(self.text(name).splitlines(), start=1)

    def is_text(self, name):
        return b"\0" not in (self.root / name).read_bytes()[:4096]

    def includes(self, name):
        """(line, "<" or quote, header) of each include of a C++ file."""
        for number, line in self.lines(name):
            found = INCLUDE.match(line)
            if found:
                yield number, found[1], found[2]

    def included_file(self, name, header):
        """The file of the project that `header`, included by `name`, means; None for others' headers."""
        for candidate in (Path(name).parent / header, Path("include") / header, Path("test") / header):
            if (self.root / candidate).is_file():
                return str(candidate)
        return None

    def closure(self, name):
        """`name` and every file of the project it includes, directly or not."""
        reached, open_files = set(), [name]
        while open_files:
            current = open_files.pop()
            if current not in reached:
                reached.add(current)
                headers = (self.included_file(current, header)
                           for _, _, header in self.includes(current))
                open_files.extend(header for header in headers if header)
        return sorted(reached)

    def fingerprint(self, name, *extra):
        """Hash of a C++ file, of all it includes from the project, and of `extra`."""
        digest = hashlib.sha256("\0".join(extra).encode())
        for member in self.closure(name):
            digest.update(member.encode() + b"\0" + self.text(member).encode() + b"\0")
        return digest.hexdigest()
