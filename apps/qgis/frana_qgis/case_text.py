"""The text of a case file from values. Knows nothing of QGIS."""
import json
import re

from .program import Trouble

_SET = re.compile(r"[A-Za-z_][\w-]*(\.[\w-]+)+\s*=\s*\S.*")


def toml(value):
    """A number, text, flag or list as TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml(item) for item in value) + "]"
    if isinstance(value, (int, float)):
        return repr(value)
    return json.dumps(str(value), ensure_ascii=False).replace("\x7f", "\\u007f")  # TOML's basic strings are JSON's


def text(values):
    """{"grid.cell": 5.0, "release.depth": 1.5, ...} -> a case file; release is a table that may come several times."""
    tables = {}
    for key, value in values.items():
        table, name = key.rsplit(".", 1)
        tables.setdefault(table, []).append(f"{name} = {toml(value)}\n")
    lines = []
    for table, entries in tables.items():
        lines.append(f"[[{table}]]\n" if table == "release" else f"[{table}]\n")
        lines.extend(entries)
    return "".join(lines)


def sets(given):
    """Lines KEY=VALUE -> --set arguments. Empty lines and lines that begin with # are left out."""
    arguments = []
    for line in given.splitlines():
        line = line.strip()
        if not line or line.startswith("#"):
            continue
        if not _SET.fullmatch(line):
            raise Trouble(f"SET: found {line!r}; expected a line KEY=VALUE such as scheme.cfl=0.4; "
                          "`frana describe` lists the keys")
        arguments += ["--set", line]
    return arguments
