# SPDX-License-Identifier: Apache-2.0
"""Writes the folder of a case: recordings and case.toml."""
import numpy as np


def write_table(file, columns):
    """A CSV with the given columns, name → values, with seven significant digits."""
    names = list(columns)
    rows = np.stack([np.asarray(columns[name], dtype=float) for name in names], axis=1)
    with open(file, "w") as out:
        out.write(",".join(names) + "\n")
        np.savetxt(out, rows, fmt="%.7g", delimiter=",")


def value_of(value):
    """A value in TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return '"' + value + '"'
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(value_of(item) for item in value) + "]"
    return repr(float(value)) if isinstance(value, (float, np.floating)) else str(int(value))


def _table(lines, path, table):
    plain = {key: value for key, value in table.items() if not isinstance(value, dict) and not _is_list_of_tables(value)}
    if path and (plain or not table):
        lines.append(f"\n[{path}]")
    lines += [f"{_key(key)} = {value_of(value)}" for key, value in plain.items()]
    for key, value in table.items():
        inner = f"{path}.{_key(key)}" if path else _key(key)
        if isinstance(value, dict):
            _table(lines, inner, value)
        elif _is_list_of_tables(value):
            for item in value:
                lines.append(f"\n[[{inner}]]")
                _table_body(lines, inner, item)


def _table_body(lines, path, item):
    lines += [f"{_key(key)} = {value_of(value)}" for key, value in item.items() if not isinstance(value, dict)]
    for key, value in item.items():
        if isinstance(value, dict):
            _table(lines, f"{path}.{_key(key)}", value)


def _is_list_of_tables(value):
    return isinstance(value, list) and bool(value) and isinstance(value[0], dict)


def _key(key):
    return key if key.replace("_", "").replace("-", "").isalnum() else f'"{key}"'


def toml_of(document):
    lines = []
    _table(lines, "", document)
    return "\n".join(lines) + "\n"


def write_case(folder, document, tables):
    """@param tables  file name → columns"""
    folder.mkdir(parents=True, exist_ok=True)
    for name, columns in tables.items():
        write_table(folder / name, columns)
    (folder / "case.toml").write_text(toml_of({"format": 1} | document))
