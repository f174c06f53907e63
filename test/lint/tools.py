# SPDX-License-Identifier: BSD-3-Clause
"""Checks done by other programs: clang-format, clang-tidy, the compiler, catkin_lint, shellcheck."""

import json
import os
import re
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from project import Finding, Skipped
from texts import is_script

FORMAT_VERSION = 14


def need(program):
    if shutil.which(program) is None:
        raise Skipped(f"{program} is not installed; ./run lint installs it")


def run(project, *command, **options):
    return subprocess.run(command, cwd=project.root, capture_output=True, text=True, check=False, **options)


def jobs():
    return int(os.environ.get("RAVEN_JOBS") or os.cpu_count() or 1)


def parse(output, rule, project, pattern=r"^(?P<path>[^:\n]+):(?P<line>\d+):(?:\d+:)? *(?P<text>.+)$"):
    """Findings out of `path:line:column: text` output; paths become relative to the root."""
    for found in re.finditer(pattern, output, re.MULTILINE):
        path = found["path"]
        path = os.path.relpath(path, project.root) if os.path.isabs(path) else path
        yield Finding(path, int(found["line"]), rule, found["text"])


def check_format(project):
    """clang-format would change nothing (.clang-format; version 14, others differ in details)."""
    need("clang-format")
    version = re.search(r"version (\d+)", run(project, "clang-format", "--version").stdout)
    if version is None or int(version[1]) != FORMAT_VERSION:
        raise Skipped(f"clang-format {FORMAT_VERSION} wanted, found {version[1] if version else 'none'}")
    names = project.matching(r"(src|include|test|bench|fuzz)/.*\.(h|cpp)")
    if names:
        result = run(project, "clang-format", "--dry-run", "--Werror", *names)
        worst = {}
        for finding in parse(result.stderr, "format", project,
                             r"^(?P<path>[^:\n]+):(?P<line>\d+):\d+: error: (?P<text>.+)$"):
            worst.setdefault(finding.path, finding)
        for finding in worst.values():
            yield Finding(finding.path, finding.line, "format", f"run clang-format -i {finding.path}")


def cached(project, folder, names, fingerprint, work):
    """Findings of work(name) for each name; what was clean at the same fingerprint is not done again."""
    memory = project.build / "lint" / folder
    memory.mkdir(parents=True, exist_ok=True)

    def one(name):
        stamp = memory / fingerprint(name)
        if stamp.exists():
            return []
        findings = list(work(name))
        if not findings:
            stamp.touch()
        return findings

    with ThreadPoolExecutor(jobs()) as pool:
        for findings in pool.map(one, names):
            yield from findings


def check_headers_alone(project):
    """Each public header compiles alone, and twice in one file (the build shows the first of headers that a
    source includes before all else)."""
    if project.build is None:
        raise Skipped("no build folder given")
    shown = {f"include/{first[1]}" for name in compiled_sources(project)
             if (first := re.search(r'^#include\s+["<]([^">]+)', project.text(name), re.MULTILINE))}
    # The folders in which the build finds the headers of others.
    folders = {folder for command in compiled_sources(project).values()
               for folder in re.findall(r"-isystem\s*(\S+)", command)}
    others = [f"-isystem{folder}" for folder in sorted(folders)]
    command = ["g++", "-std=c++17", "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow",
               "-Werror", "-fopenmp", f"-I{project.root}/include", *others, "-x", "c++", "-"]

    def compile_alone(name):
        if name in shown and "#pragma once" in project.text(name):
            return
        header = name.split("/", 1)[1]
        result = run(project, *command, input=f'#include "{header}"\n' * 2)
        if result.returncode:
            error = re.search(r"^(.*(?:error).*)$", result.stderr, re.MULTILINE)
            yield Finding(name, 1, "alone", "does not compile alone; include what it uses: "
                          + (error[1] if error else result.stderr.strip()))

    yield from cached(project, "alone", project.matching(r"include/.*\.h"),
                      lambda name: project.fingerprint(name, str(name in shown), *command), compile_alone)


def compiled_sources(project):
    """name -> command line, from the compilation database; only files of the project."""
    database = project.build / "compile_commands.json"
    if not database.exists():
        raise Skipped(f"{database} is missing; run ./run build first")
    entries = {}
    for entry in json.loads(database.read_text()):
        path = Path(entry["directory"], entry["file"]).resolve()
        if project.root in path.parents:
            entries[str(path.relative_to(project.root))] = entry["command"]
    return {name: command for name, command in entries.items() if name in set(project.files)}


def tidy(project, folder, *options):
    need("clang-tidy")
    if project.build is None:
        raise Skipped("no build folder given")
    sources = compiled_sources(project)
    configuration = project.text(".clang-tidy")
    # clang has no omp.h of its own without another package; the compiler that builds us has one.
    headers = run(project, "g++", "-print-file-name=include").stdout.strip()
    command = ["clang-tidy", "--quiet", *options, f"--extra-arg=-idirafter{headers}", "-p", str(project.build)]

    def look(name):
        result = run(project, *command, str(project.root / name))
        yield from dict.fromkeys(parse(
            result.stdout, "tidy", project,
            r"^(?P<path>[^:\n]+):(?P<line>\d+):\d+: (?:error|warning): (?P<text>.+?)(?:,-warnings-as-errors)?\]?$"))

    findings = cached(project, folder, sorted(sources),
                      lambda name: project.fingerprint(name, configuration, sources[name], *command), look)
    yield from dict.fromkeys(findings)


def check_names(project):
    """Names follow the conventions: the naming rules of .clang-tidy, in all sources and headers."""
    for finding in tidy(project, "names", "--checks=-*,readability-identifier-naming"):
        yield Finding(finding.path, finding.line, "names", finding.text)


def check_tidy(project):
    """All of .clang-tidy: slow, so only with --tidy."""
    yield from tidy(project, "tidy")


def check_architecture(project):
    """No file that sees Eigen is compiled for a special processor: Eigen's types would change size."""
    if project.build is None:
        raise Skipped("no build folder given")
    for name, command in sorted(compiled_sources(project).items()):
        flag = re.search(r"(?<=\s)-m(arch=|avx|sse[34]|fma|tune=native)\S*", command)
        if not flag:
            continue
        for member in project.closure(name):
            for line, _, header in project.includes(member):
                if header.startswith(("Eigen/", "unsupported/Eigen")):
                    yield Finding(member, line, "architecture", f"{name} is compiled with {flag[0]} and sees "
                                  "Eigen here; keep such kernels in files of raw pointers")


def check_catkin(project):
    """catkin_lint finds no error and no warning in package.xml and the CMake files."""
    need("catkin_lint")
    # `run` and its like are for the source folder, not for the install space.
    result = run(project, "catkin_lint", "--offline", "-q", "-W1", "--ignore", "uninstalled_script", ".")
    for line in result.stdout.splitlines():
        found = re.match(r"[^:]+: (?P<path>[^(:]+)(?:\((?P<line>\d+)\))?: (?P<text>(?:error|warning): .+)", line)
        if found:
            yield Finding(found["path"], int(found["line"] or 1), "catkin", found["text"])
        elif line.strip():
            yield Finding("package.xml", 1, "catkin", line.strip())


def check_shell(project):
    """shellcheck finds nothing in our shell scripts."""
    need("shellcheck")
    scripts = [name for name in project.files if name.endswith(".sh")
               or (is_script(project, name) and re.match(r"#!.*\b(ba)?sh\b", project.text(name)))]
    if scripts:
        result = run(project, "shellcheck", "--external-sources", "--format=gcc", *scripts)
        yield from parse(result.stdout, "shell", project)


def check_python(project):
    """Our Python files are valid for the system's Python."""
    for name in project.files:
        if name.endswith(".py") or (is_script(project, name)
                                    and "python" in project.text(name).splitlines()[0]):
            try:
                compile(project.text(name), name, "exec")
            except SyntaxError as error:
                yield Finding(name, error.lineno or 1, "python", str(error.msg))
