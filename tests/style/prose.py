#!/usr/bin/env python3
"""Counts the prose of this project: how often "what" stands for a noun, and how long sentences are.

    tests/style/prose.py [--files] [PATH…]

Prints, for docs, comments and messages: words, "what" per 1,000 words and, for docs, words per sentence.
--files adds a line per file, the worst first; PATH… restricts the count to these files or folders.
Exits with 1 if a limit is exceeded. Standard library only.
"""
import argparse
import pathlib
import re
import subprocess
import sys

TREE = pathlib.Path(__file__).resolve().parents[2]
LIMITS = {"docs": 1.0, "messages": 1.0, "comments": 2.0}  # "what" per 1,000 words
WORDS_PER_SENTENCE = 20.0  # average in docs

WORD = re.compile(r"[A-Za-zÀ-ɏͰ-Ͽ][\w'’.-]*|\d[\w.,]*")
WHAT = re.compile(r"\bwhat\b", re.IGNORECASE)
CPP = re.compile(r"""
    (?P<line>//[^\n]*) | (?P<block>/\*.*?\*/)
  | R"(?P<delimiter>[^()\s\\]*)\((?P<raw>.*?)\)(?P=delimiter)"
  | "(?P<string>(?:\\.|[^"\\\n])*)" | '(?:\\.|[^'\\\n])'""", re.VERBOSE | re.DOTALL)
INCLUDE = re.compile(r"^\s*#\s*include[^\n]*", re.MULTILINE)


def tracked(paths):
    """Files of the project below the given paths; outside a checkout, all files."""
    listing = subprocess.run(["git", "-c", f"safe.directory={TREE}", "ls-files", "-co", "--exclude-standard", *paths],
                             cwd=TREE, capture_output=True, text=True, check=True)
    return [TREE / name for name in listing.stdout.splitlines() if (TREE / name).is_file()]


def prose_of_markdown(text):
    """The text of a page without code, addresses of links, and HTML comments."""
    text = re.sub(r"^(```|~~~).*?^\1", "", text, flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\([^)]*\)", r"\2", text)
    return re.sub(r"`[^`\n]*`", "code", text)


def sentences(page):
    """Sentences of paragraphs and list items; headings, tables and figures of tables are none."""
    blocks, block = [], []
    for line in page.splitlines() + [""]:
        starts_item = re.match(r"\s*([-*+]|\d+\.)\s", line)
        ends = not line.strip() or line.lstrip().startswith(("#", "|"))
        if (ends or starts_item) and block:
            blocks.append(" ".join(block))
            block = []
        if not ends:
            block.append(re.sub(r"^\s*([-*+>]|\d+\.)\s+", "", line).strip())
    for text in blocks:
        for sentence in re.split(r"(?<=[.!?])[\"'*_)]*\s+(?=[\"'*_(]*[A-Z0-9À-ɏͰ-Ͽ])", text):
            if len(WORD.findall(sentence)) >= 3:
                yield sentence


def parts_of_cpp(text):
    """Comments and string literals of a C or C++ source."""
    comments, messages = [], []
    for match in CPP.finditer(INCLUDE.sub("", text)):
        comment = match["line"] or match["block"]
        if comment:
            comments.append(comment)
        else:
            literal = match["raw"] if match["raw"] is not None else match["string"]
            if literal and " " in literal.strip():
                messages.append(literal)
    return "\n".join(comments), "\n".join(messages)


def parts_of_script(text):
    """Comments and quoted texts of a script or a configuration."""
    comments = "\n".join(re.findall(r"(?:^|\s)#(?!!)([^\n]*)", text))
    comments += "\n".join(part[3:-3] for part in re.findall(r'""".*?"""', text, re.DOTALL))
    messages = [quoted for quoted in re.findall(r'"((?:\\.|[^"\\\n])*)"', text) if " " in quoted.strip()]
    return comments, "\n".join(messages)


def parts_of(path):
    """(kind, text) pairs of a file."""
    text = path.read_text(errors="replace")
    if path.suffix == ".md":
        return [("docs", prose_of_markdown(text))]
    if path.suffix in (".cpp", ".hpp", ".h", ".c", ".inc", ".js", ".pml", ".idl", ".css"):
        comments, messages = parts_of_cpp(text)
    elif path.suffix in (".py", ".cmake", ".toml", ".sh") or path.name in ("lab", "run", "CMakeLists.txt", "serves_vendor_clients"):
        comments, messages = parts_of_script(text)
    else:
        return []
    return [("comments", comments), ("messages", messages)]


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--files", action="store_true", help="a line per file, the worst first")
    arguments.add_argument("paths", nargs="*", help="files or folders; the whole tree if none is named")
    options = arguments.parse_args()
    totals = {kind: [0, 0, 0, 0] for kind in LIMITS}  # words, whats, sentences, words in sentences
    rows = []
    for path in tracked(options.paths):
        if path == pathlib.Path(__file__).resolve():
            continue
        for kind, text in parts_of(path):
            found = list(sentences(text)) if kind == "docs" else []
            row = [len(WORD.findall(text)), len(WHAT.findall(text)), len(found),
                   sum(len(WORD.findall(sentence)) for sentence in found)]
            totals[kind] = [a + b for a, b in zip(totals[kind], row)]
            rows.append((kind, path.relative_to(TREE), row))
    if options.files:
        for kind, path, row in sorted(rows, key=lambda entry: (entry[0], -entry[2][1], -entry[2][3])):
            if row[1] or (kind == "docs" and row[2]):
                length = f", {row[3] / row[2]:.1f} words a sentence" if row[2] else ""
                print(f"{kind:9} {path}: {row[1]} in {row[0]} words{length}")
    exceeded = False
    for kind, (words, whats, count, in_sentences) in totals.items():
        rate = 1000 * whats / words if words else 0.0
        line = f"{kind}: {words} words, \"what\" {whats} times, {rate:.2f} per 1,000 (at most {LIMITS[kind]:g})"
        exceeded |= rate > LIMITS[kind]
        if count:
            length = in_sentences / count
            line += f"; {count} sentences of {length:.1f} words on average (at most {WORDS_PER_SENTENCE:g})"
            exceeded |= length > WORDS_PER_SENTENCE
        print(line)
    return 1 if exceeded else 0


if __name__ == "__main__":
    sys.exit(main())
