# SPDX-License-Identifier: Apache-2.0
"""Puts a part of a TOML file, as a page shows it, into a whole file."""
import json
import tomllib


def merged(base, part):
    """The base with the keys of the part. A list of tables is replaced by that of the part; a table goes into its last one."""
    if isinstance(base, list):
        return base[:-1] + [merged(base[-1], part)]
    result = dict(base)
    for key, value in part.items():
        both = isinstance(value, dict) and isinstance(result.get(key), (dict, list))
        result[key] = merged(result[key], value) if both else value
    return result


def text_of(value):
    """A value in TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, list):
        return "[" + ", ".join(text_of(item) for item in value) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {text_of(item)}" for key, item in value.items()) + "}"
    return repr(value)


def whole(file, without, texts, folder):
    """The content of a file (or of none), without some tables, with the keys of texts. Its paths still start at its own folder."""
    base = tomllib.loads(file.read_text()) if file else {}
    for path in without:
        *tables, last = path.split(".")
        table = base
        for name in tables:
            table = table[name][-1] if isinstance(table[name], list) else table[name]
        del table[last]
    for text in texts:
        base = merged(base, tomllib.loads(text))
    if file and file.parent != folder:
        base.setdefault("folder", str(file.parent))
    return "".join(f"{json.dumps(key)} = {text_of(value)}\n" for key, value in base.items())
