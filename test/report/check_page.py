# SPDX-License-Identifier: BSD-3-Clause
"""Reads a page (or one <svg>) as XML and prints what is wrong with it, a line each: not well-formed, a
script, a reference to anything outside, an id used twice, a picture without words, numbers that are none."""

import re
import sys
import xml.etree.ElementTree as ElementTree

SVG = "{http://www.w3.org/2000/svg}"


def problems(path):
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        yield f"not well-formed: {error}"
        return
    known = set()
    pictures = 0
    for element in root.iter():
        name = element.tag.split("}")[-1]
        if name in ("script", "link", "img", "image", "iframe", "object", "use", "foreignObject"):
            yield f"<{name}>"
        for key, value in element.attrib.items():
            if key.split("}")[-1] in ("href", "src") and not value.startswith("#"):
                yield f"{key}={value} points outside"
            if key.startswith("on") or "url(" in value:
                yield f"{key}={value}"
            if key == "id" and (value in known or known.add(value)):
                yield f"id {value} twice"
            if element.tag.startswith(SVG) and re.search(r"\b(nan|inf)\b", value, re.IGNORECASE):
                yield f"<{name} {key}={value[:40]}>"
        if name == "a" and element.get("href", "")[1:] not in {e.get("id") for e in root.iter()}:
            yield f"link to {element.get('href')}, which is not there"
        if name == "style" and re.search(r"@import|url\(|http", element.text or ""):
            yield "the style sheet loads something"
        if element.tag == SVG + "svg" and element.get("role") == "img":
            pictures += 1
            for word in ("title", "desc"):
                if element.find(SVG + word) is None:
                    yield f"picture without <{word}>"
    print(f"{pictures} pictures", file=sys.stderr)


if __name__ == "__main__":
    found = list(problems(sys.argv[1]))
    print("\n".join(found))
    sys.exit(1 if found else 0)
