# SPDX-License-Identifier: BSD-3-Clause
"""The order of the rooms: who includes whom, and that the core knows nothing of ROS (rooms.yaml)."""

import re
import subprocess
from pathlib import Path

import yaml

from project import Finding, Skipped

STANDARD = re.compile(r"^[a-z_0-9]+$|^(unistd|fcntl|time|sys/\w+|pthread|sched|malloc|glob|signal|netinet/in)\.h$")


def load_table(project):
    table = yaml.safe_load(project.text("test/lint/rooms.yaml"))
    above = []
    for room, entry in table["rooms"].items():
        direct = list(above) if entry["uses"] == "everything" else entry["uses"]
        entry["all"] = set(direct).union(*(table["rooms"][used]["all"] for used in direct)) | {room}
        above.append(room)
    return table


def room_of(name):
    """Room of a source or public header, "" for a header that belongs to none, None for other files."""
    found = re.fullmatch(r"(?:src|include/raven_correction)/(?:([^/]+)/)?.*\.(?:h|cpp)", name)
    return (found[1] or "") if found else None


def check_rooms(project):
    """Includes of src/ and include/ keep to the table of the design (test/lint/rooms.yaml)."""
    table = load_table(project)
    rooms, libraries = table["rooms"], table["libraries"]
    for name in project.matching(r"(src|include)/.*\.(h|cpp)"):
        room = room_of(name)
        if room is None or (room and room not in rooms):
            yield Finding(name, 1, "rooms", "lies in no room; put it in one of " + ", ".join(rooms))
            continue
        if not room and Path(name).name not in table["common"] and name.endswith(".h"):
            yield Finding(name, 1, "rooms", "a public header outside the rooms; move it into a room, or "
                          "list it under `common` in test/lint/rooms.yaml if every room may use it")
        allowed = rooms[room] if room else {"all": set(), "libraries": []}
        for line, _, header in project.includes(name):
            yield from check_include(project, table, name, line, header, room, allowed)


def check_independent(project):
    """Test support that has to be independent of the rooms it checks includes none of them (rooms.yaml)."""
    table = load_table(project)
    for folder, entry in table["independent"].items():
        uses = set(entry["uses"]).union(*(table["rooms"][used]["all"] for used in entry["uses"]))
        allowed = {"all": uses, "libraries": entry["libraries"]}
        for name in project.matching(re.escape(folder) + r"/.*(?<!_test)\.(h|cpp)"):
            for line, _, header in project.includes(name):
                if header.startswith(Path(folder).name + "/"):
                    continue
                yield from check_include(project, table, name, line, header, folder, allowed)


def check_include(project, table, name, line, header, room, allowed):
    who = f"room {room}" if room else "a header of all rooms"
    library = next((library for library, pattern in table["libraries"].items()
                    if re.match(pattern, header)), None)
    if library:
        if library not in allowed["libraries"]:
            yield Finding(name, line, "rooms", f"{who} may not use {library} ({header}); allowed here: "
                          + (", ".join(allowed["libraries"]) or "the standard library"))
        return
    target = project.included_file(name, header)
    if target is None:
        if header.startswith("raven_correction/"):
            yield Finding(name, line, "rooms", f"{header} does not exist")
        elif not STANDARD.match(header):
            yield Finding(name, line, "rooms", f"{header} is from a library that test/lint/rooms.yaml does "
                          "not know; add it there, to `libraries` and to the rooms that may use it")
        return
    other = room_of(target)
    if other and other not in allowed["all"]:
        may = ", ".join(sorted(allowed["all"] - {room})) or "no other room"
        yield Finding(name, line, "rooms", f"{who} may not use room {other} ({header}); it may use {may}")


def check_core_without_ros(project):
    """The built core library is linked with nothing but what rooms.yaml lists; ROS is not listed."""
    if project.build is None:
        raise Skipped("no build folder given")
    library = project.build / "devel/lib/libraven_correction_core.so"
    if not library.exists():
        yield Finding(str(library), 1, "core", "is not built; run ./run build first")
        return
    listing = subprocess.run(["readelf", "-d", str(library)], capture_output=True, text=True, check=True)
    patterns = load_table(project)["core_links"]
    for needed in re.findall(r"\(NEEDED\).*\[(.+)\]", listing.stdout):
        if not any(re.match(pattern, needed) for pattern in patterns):
            yield Finding("CMakeLists.txt", 1, "core", f"raven_correction_core is linked with {needed}, which "
                          "`core_links` in test/lint/rooms.yaml does not list; core knows no ROS")
