"""The mutants of a C file: small changes of its arithmetic and its decisions. A test should notice each.

The file is read as tokens. clang-format puts blanks around binary operators, which identifies them. A change that does not compile is no
mutant; the build finds these.
"""
import dataclasses
import re

TOKEN = re.compile(r"""
    (?P<skip>/\*.*?\*/|//[^\n]*|^[ \t]*\#[ \t]*(?!define\b)\w+(?:\\\n|[^\n])*|"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|\s+)
  | (?P<number>0[xX][0-9a-fA-F]+[uUlL]*|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[uUlLfF]*)
  | (?P<word>[A-Za-z_]\w*)
  | (?P<mark><<=|>>=|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|.)
""", re.VERBOSE | re.DOTALL | re.MULTILINE)

BINARY = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"), "==": ("!=",), "!=": ("==",), "&&": ("||",),
          "||": ("&&",), "+": ("-",), "-": ("+",), "*": ("+",), "/": ("*",), "%": ("*",), "<<": (">>",), ">>": ("<<",), "&": ("|",),
          "|": ("&",), "^": ("&",), "+=": ("-=",), "-=": ("+=",), "*=": ("/=",), "/=": ("*=",), "|=": ("&=",), "&=": ("|=",),
          "^=": ("|=",)}
RELATIONS = {"<", "<=", ">", ">=", "==", "!="}
MEMBERS = {"a": "b", "b": "c", "c": "a", "d": "q", "q": "d", "alpha": "beta", "beta": "alpha", "sin": "cos", "cos": "sin", "re": "im",
           "im": "re"}
# The library's arithmetic is spelt as calls: the other sign, the other end, no rounding, no saturation.
CALLS = {"iq24_add_wrap": "iq24_sub_wrap", "iq24_sub_wrap": "iq24_add_wrap", "iq24_add_sat": "iq24_sub_sat",
         "iq24_sub_sat": "iq24_add_sat", "iq24_min": "iq24_max", "iq24_max": "iq24_min", "iq24_mul_round": "iq24_mul_trunc",
         "iq24_acc_round": "iq24_acc_trunc", "iq24_mul_sat": "iq24_mul_round", "iq24_acc_sat": "iq24_acc_round"}
NO_STATEMENT = {"return", "if", "for", "while", "switch", "case", "default", "do", "else", "const", "static", "typedef", "struct", "enum",
                "union", "goto", "extern", "inline", "volatile", "unsigned", "signed"}
DECLARATION = re.compile(r"\w+(?:\s+\*?|\s*\*+\s*)\w+\s*[=;,\[(]")
HEAD = re.compile(r"(\w+)\s+(\*?)(\w+)\([^;{}]*\)\s*$")
WHOLE = {"int32_t", "uint32_t", "int64_t", "uint64_t", "iq24_t", "iq24_acc_t", "int", "size_t"}


@dataclasses.dataclass(frozen=True)
class Mutant:
    file: str
    start: int
    end: int
    new: str
    line: int
    key: str  # file and line with {old=>new}: names the mutant, and stays while lines come and go around it
    text: str  # the file's, unchanged

    def changed(self):
        return self.text[:self.start] + self.new + self.text[self.end:]


class Token:
    def __init__(self, match):
        self.kind, self.text, self.start, self.end = match.lastgroup, match[0], match.start(), match.end()


def tokens(text):
    return [token for token in map(Token, TOKEN.finditer(text)) if token.kind != "skip"]


def closing(toks, at):
    """The index of the bracket that closes the one at `at`."""
    depth = 0
    for k in range(at, len(toks)):
        depth += (toks[k].text in "([{") - (toks[k].text in ")]}")
        if depth == 0:
            return k
    return len(toks) - 1


def bodies(text, toks):
    """(index of {, index of }, return type) of each function."""
    found, k = [], 0
    while k < len(toks):
        if toks[k].text == "{":
            end = closing(toks, k)
            if k > 0 and toks[k - 1].text == ")":
                head = HEAD.search(text[:toks[k].start])
                found.append((k, end, "" if head is None or head[2] else head[1]))
                k = end
            elif k > 0 and text[:toks[k].start].rstrip().endswith('extern "C"'):
                pass
            else:
                k = end
        k += 1
    return found


def spaced(text, token):
    return text[token.start - 1].isspace() and text[token.end:token.end + 1].isspace()


def one_more(number, by):
    digits = re.match(r"0[xX][0-9a-fA-F]+|\d+", number)[0]
    value = int(digits, 0) + by
    return (f"0x{value:0{len(digits) - 2}X}" if digits[:2] in ("0x", "0X") else str(value)) + number[len(digits):]


def of_numbers(toks):
    """Integer constants one up and one down, IQ24() constants one LSB."""
    k = 0
    while k < len(toks):
        token = toks[k]
        if token.text == "IQ24" and k + 1 < len(toks) and toks[k + 1].text == "(" and toks[k - 1].text != "define":
            end = closing(toks, k + 1)
            for by in ("+ 1", "- 1"):
                yield toks[end].end, toks[end].end, f" {by}"
            k = end
        elif token.kind == "number" and not re.search(r"[.eE]|[fF]$", token.text.replace("0x", "").replace("0X", "")
                                                     if not token.text.lower().startswith("0x") else "0"):
            for by in (1, -1):
                if int(re.match(r"0[xX][0-9a-fA-F]+|\d+", token.text)[0], 0) + by >= 0:
                    yield token.start, token.end, one_more(token.text, by)
        k += 1


def of_marks(text, toks):
    for k, token in enumerate(toks):
        before, after = toks[k - 1] if k else None, toks[k + 1] if k + 1 < len(toks) else None
        if token.text in BINARY and spaced(text, token):
            for new in BINARY[token.text]:
                yield token.start, token.end, new
        elif token.text in ("++", "--"):
            yield token.start, token.end, "--" if token.text == "++" else "++"
        elif token.text in "-!~" and after is not None and token.end == after.start and after.kind != "number":
            yield token.start, token.end, ""
        elif token.kind == "word" and before is not None and before.text in (".", "->") and token.text in MEMBERS:
            if after is None or after.text != "=" or toks[k - 2].text not in ("{", ","):
                yield token.start, token.end, MEMBERS[token.text]
        elif token.text in CALLS:
            yield token.start, token.end, CALLS[token.text]


def of_roundings(text, toks):
    """A constant of half a unit, added ahead of a shift, left out."""
    for k in range(1, len(toks) - 1):
        if toks[k].text == "+" and toks[k + 1].text in ("IQ24_ACC_HALF", "half", "ROUND_Q6"):
            yield toks[k].start - 1, toks[k + 1].end, ""
        elif toks[k].text == "+" and toks[k + 1].kind == "number" and k + 2 < len(toks) and toks[k + 2].text in (",", ")") \
                and re.fullmatch(r"2|4|8|16|32|64|128", toks[k + 1].text) and spaced(text, toks[k]):
            yield toks[k].start - 1, toks[k + 1].end, ""


def of_conditions(toks, start, end):
    """Conditions without a relation (those are turned round by it) negated, in if, while and before a question mark."""
    for k in range(start, end):
        if toks[k].text in ("if", "while") and toks[k + 1].text == "(":
            last = closing(toks, k + 1)
            if not RELATIONS & {token.text for token in toks[k + 1:last]}:
                yield toks[k + 1].end, toks[k + 1].end, "!("
        elif toks[k].text == "?":
            first = k
            while toks[first - 1].kind == "word" and toks[first - 1].text != "return" or toks[first - 1].text in (".", "->"):
                first -= 1
            if first < k and toks[first - 1].text in ("=", "(", "return", ",", "?", ":", "&&", "||", "{"):
                yield toks[first].start, toks[first].start, "!"


def of_statements(text, toks, start, end):
    """Statements left out: assignments, calls, counts, leaving a loop."""
    k = start + 1
    while k < end:
        first = k
        if toks[k].text in (";", "{", "}", ":") or toks[k].text in NO_STATEMENT:
            if toks[k].text in ("if", "while", "for", "switch"):
                k = closing(toks, k + 1)
            elif toks[k].text in ("return", "case", "goto", "const", "static", "volatile"):
                stop = ":" if toks[k].text == "case" else ";"
                while toks[k].text != stop and k < end:
                    k = closing(toks, k) if toks[k].text in "([{" else k
                    k += 1
            k += 1
            continue
        while toks[k].text != ";" and k < end:
            if toks[k].text == ":" and k == first + 1:
                break  # a label
            k = closing(toks, k) if toks[k].text in "([{" else k
            k += 1
        statement = text[toks[first].start:toks[k].end]
        if toks[k].text == ";" and not DECLARATION.match(statement) and not statement.startswith(("(", "__asm")):
            yield toks[first].start, toks[k].end, ";"
        k += 1


def of_returns(text, toks, start, end, kind):
    for k in range(start, end):
        if toks[k].text != "return" or toks[k + 1].text == ";":
            continue
        last = k
        while toks[last].text != ";":
            last = closing(toks, last) if toks[last].text in "([{" else last
            last += 1
        value = text[toks[k + 1].start:toks[last].start]
        if kind == "bool":
            yield toks[k + 1].start, toks[last].start, {"true": "false", "false": "true"}.get(value, f"!({value})")
        elif kind in WHOLE:
            yield toks[k + 1].start, toks[last].start, f"({value}) + 1"
        elif kind == "iqfoc_error_t":
            yield toks[k + 1].start, toks[last].start, f"({kind})(({value}) + 1)"


def changes(text):
    toks = tokens(text)
    yield from of_numbers(toks)
    yield from of_marks(text, toks)
    yield from of_roundings(text, toks)
    for start, end, kind in bodies(text, toks):
        for first, last, new in of_conditions(toks, start, end):
            if new == "!(":
                close = toks[closing(toks, next(k for k in range(start, end) if toks[k].end == first))].start
                yield first, close, f"!({text[first:close]})"
            else:
                yield first, last, new
        yield from of_statements(text, toks, start, end)
        yield from of_returns(text, toks, start, end, kind)


def squeezed(text):
    return " ".join(text.split())


def mutants(file, text):
    """All mutants of the file, in the order of their places."""
    found, seen, names = [], set(), {}
    for start, end, new in sorted(changes(text), key=lambda change: change[:2]):
        if (start, end, new) in seen or text[start:end] == new:
            continue
        seen.add((start, end, new))
        first, last = text.rfind("\n", 0, start) + 1, text.find("\n", end)
        shown = squeezed(f"{text[first:start]}{{{squeezed(text[start:end])}=>{squeezed(new)}}}{text[end:last]}")
        names[shown] = names.get(shown, 0) + 1
        key = f"{file}: {shown}" + (f" #{names[shown]}" if names[shown] > 1 else "")
        found.append(Mutant(file, start, end, new, text.count("\n", 0, start) + 1, key, text))
    return found
