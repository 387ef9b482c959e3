"""Functions and types of a C or C++ source, from its braces. No preprocessor, no library."""
import re
from dataclasses import dataclass

MASKED = re.compile(r"""
    //[^\n]* | /\*.*?\*/
  | R"(?P<delimiter>[^()\s\\]*)\(.*?\)(?P=delimiter)"
  | "(?:\\.|[^"\\\n])*" | (?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+'
  | ^[ \t]*\#(?:\\\n|[^\n])*""", re.VERBOSE | re.DOTALL | re.MULTILINE)
TOKEN = re.compile(r"\w+|::|->|\[\[|\]\]|[^\s\w]")
TYPE_WORDS = ("class", "struct", "union", "enum")
NO_FUNCTIONS = ("alignas", "decltype", "noexcept", "requires", "__attribute__")
BEFORE_A_TYPE = ("typedef", "static", "const", "constexpr", "inline", "export", "extern")


@dataclass
class Function:
    name: str
    line: int
    lines: int  # line breaks between its braces, as clang-tidy counts them
    body: str   # without comments and texts


@dataclass
class Type:
    name: str
    space: str  # its namespaces, as in "rths::sim"; "(anonymous)" for one without a name
    line: int


@dataclass
class Scope:
    kind: str  # namespace, type, function, or other: anything between braces that defines none of these
    name: str
    start: int
    saved: tuple  # statement and depth of parentheses outside, for an initializer


def masked(text):
    """The text with comments, quoted texts and directives as blanks, at the same lines and columns."""
    return MASKED.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), text)


def without_template(statement):
    """The statement after `template <…>` and `requires`-free attributes."""
    while statement and statement[0] == "template":
        depth, at = 0, 1
        while at < len(statement):
            depth += {"<": 1, ">": -1}.get(statement[at], 0)
            at += 1
            if depth == 0:
                break
        statement = statement[at:]
    return statement


def at_top(statement):
    """(index, token) outside of parentheses, attributes and angle brackets; the brackets themselves included."""
    round_depth = angle_depth = square_depth = 0
    previous = ""
    for index, token in enumerate(statement):
        if token in (")", "]", "]]"):
            round_depth -= token == ")"
            square_depth -= token != ")"
        elif token == ">" and angle_depth > 0 and round_depth == 0:
            angle_depth -= 1
        if round_depth == angle_depth == square_depth == 0:
            yield index, token
        if token in ("(", "[", "[["):
            round_depth += token == "("
            square_depth += token != "("
        elif token == "<" and round_depth == 0 and re.match(r"\w", previous) and previous != "operator":
            angle_depth += 1
        previous = token


def type_name(statement):
    """Name of the type that the statement before a brace defines; empty: it has none; None: it defines no type."""
    words = list(statement)
    while words and words[0] in BEFORE_A_TYPE:
        words.pop(0)
    if not words or words[0] not in TYPE_WORDS:
        return None
    top = [token for _, token in at_top(words)]
    if "alignas" in top:
        at = top.index("alignas")
        del top[at:at + 3]
    if "(" in top or "=" in top:
        return None
    if ":" in top:
        top = top[:top.index(":")]
    top = [token for token in top if token not in ("final", "[[", "]]")]
    if top[-1] == ">" or "::" in top:  # a specialization, or the definition of a nested type
        return ""
    return top[-1] if top[-1] not in TYPE_WORDS else ""


def function_name(statement):
    """Name of the function whose body or member initializer begins after the statement; None: there is no function."""
    top = list(at_top(statement))
    if "operator" in statement:
        after = statement[statement.index("operator") + 1:]
        return "operator" + ("()" if after[:2] == ["(", ")"] else "".join(after[:after.index("(")]))
    if any(token == "=" for _, token in top):
        return None
    for (_, token), (_, following) in zip(top, top[1:]):
        if following == "(" and re.match(r"[A-Za-z_]", token) and token not in NO_FUNCTIONS:
            return token
    return None


def begins_member(statement):
    """True if a brace after the statement begins the value of a member, in the list of a constructor."""
    top = [token for _, token in at_top(statement)]
    if "operator" in statement or ")" not in top or ":" not in top[top.index(")"):]:
        return False
    return statement[-1] not in (")", "}") and statement[-1] not in ("try",)


class Scanner:
    """Reads the tokens of a source once."""

    def __init__(self, text):
        self.text = masked(text)
        self.functions, self.types = [], []
        self.scopes, self.statement, self.depth = [], [], 0

    def line(self, offset):
        return self.text.count("\n", 0, offset) + 1

    def read(self):
        for found in TOKEN.finditer(self.text):
            token, at = found.group(), found.start()
            if token == "{":
                self.open(at)
            elif token == "}":
                self.close(at)
            elif token == ";" and self.depth == 0:
                self.statement = []
            elif token == ":" and self.statement in (["public"], ["private"], ["protected"]):
                self.statement = []
            else:
                self.depth += {"(": 1, ")": -1}.get(token, 0)
                self.statement.append(token)
        return self

    def open(self, at):
        inside = self.scopes[-1].kind if self.scopes else "namespace"
        kind, name = "other", ""
        if self.depth == 0 and inside in ("namespace", "type"):
            kind, name = self.kind_of(without_template(self.statement), at)
        self.scopes.append(Scope(kind, name, at, (self.statement, self.depth)))
        self.statement, self.depth = [], 0

    def kind_of(self, statement, at):
        if "namespace" in statement:
            name = "".join(statement[statement.index("namespace") + 1:])
            return "namespace", name or "(anonymous)"
        if statement in ([], ["extern"]):
            return "namespace", ""
        name = type_name(statement)
        if name is not None:
            if name and all(scope.kind == "namespace" for scope in self.scopes):
                space = "::".join(scope.name for scope in self.scopes if scope.name)
                self.types.append(Type(name, space, self.line(at)))
            return "type", name
        name = function_name(statement)
        if name and not begins_member(statement):
            return "function", name
        return "other", ""

    def close(self, at):
        if not self.scopes:
            return
        scope = self.scopes.pop()
        self.statement, self.depth = scope.saved
        if scope.kind == "function":
            body = self.text[scope.start:at + 1]
            self.functions.append(Function(scope.name, self.line(scope.start), body.count("\n"), body))
        if scope.kind == "other":
            self.statement.append("}")
        else:
            self.statement = []


def scan(text):
    """The functions and types that a source defines."""
    return Scanner(text).read()
