"""Reads .usda files that Sherd wrote, by the grammar of USD's text format and not by Sherd."""
import re

TOKEN = re.compile(r'''(?P<string>"(?:[^"\\\n]|\\.)*")
    |(?P<asset>@@@(?:\\@@@|(?!@@@).)*@@@|@[^@\n]*@)
    |(?P<path><[^<>\n]*>)
    |(?P<number>-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]))
    |(?P<word>[A-Za-z_][\w:.]*(?:\[\])?)
    |(?P<mark>[(){}\[\]=,])
    |(?P<blank>\s+)''', re.VERBOSE | re.ASCII)


class Prim:
    def __init__(self, specifier, kind, name, metadata):
        self.specifier, self.kind, self.name, self.metadata = specifier, kind, name, metadata
        self.types, self.values, self.properties = {}, {}, {}  # by name; metadata of properties
        self.children, self.variants = [], {}

    def child(self, name):
        return next(c for c in self.children if c.name == name)

    def walk(self, path=""):
        """Every prim below, this one first, by path."""
        path = f"{path}/{self.name}"
        yield path, self
        for child in self.children:
            yield from child.walk(path)


class Parser:
    """Every byte is a token's, every bracket is closed, and no name is given twice to children, properties or metadata."""

    def __init__(self, text):
        assert text.startswith("#usda 1.0\n")
        self.tokens, at, self.i = [], 10, 0
        while at < len(text):
            found = TOKEN.match(text, at)
            assert found, text[at:at + 80]
            if found.lastgroup != "blank":
                self.tokens.append((found.lastgroup, found.group()))
            at = found.end()

    def peek(self):
        return self.tokens[self.i][1] if self.i < len(self.tokens) else None

    def take(self, *expected):
        kind, text = self.tokens[self.i]
        assert not expected or text in expected or kind in expected, (expected, kind, text)
        self.i += 1
        return text

    def string(self):
        return re.sub(r"\\(x..|.)", lambda m: chr(int(m[1][1:], 16)) if len(m[1]) == 3 else m[1], self.take("string")[1:-1])

    def value(self):
        kind, text = self.tokens[self.i]
        if kind == "number":
            self.i += 1
            return float(text) if re.search("[.e]", text) else int(text)
        if kind == "string":
            return self.string()
        if text in "[(":
            self.i += 1
            items = []
            while self.peek() not in ("]", ")"):
                items.append(self.value())
                if self.peek() == ",":
                    self.take()
            self.take("]" if text == "[" else ")")
            return items if text == "[" else tuple(items)
        self.i += 1
        assert kind in ("asset", "path", "word"), (kind, text)
        if text.startswith("@@@"):
            return text[3:-3].replace("\\@@@", "@@@")
        return text.strip("@<>")

    def metadata(self):
        found = {}
        if self.peek() != "(":
            return found
        self.take("(")
        while self.peek() != ")":
            name = self.take("word")
            if name == "prepend":
                name = self.take("word")
            assert name not in found
            self.take("=")
            if self.peek() != "{":
                found[name] = self.value()
                continue
            self.take("{")
            found[name] = {}
            while self.peek() != "}":
                self.take("word")
                key = self.take("word")
                self.take("=")
                found[name][key] = self.value()
            self.take("}")
        self.take(")")
        return found

    def prim(self):
        specifier = self.take("def", "over")
        kind = "" if self.tokens[self.i][0] == "string" else self.take("word")
        name = self.string()
        assert re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name), name
        prim = Prim(specifier, kind, name, self.metadata())
        self.body(prim)
        return prim

    def body(self, prim):
        self.take("{")
        while self.peek() != "}":
            if self.peek() in ("def", "over"):
                child = self.prim()
                assert child.name not in [c.name for c in prim.children], child.name
                prim.children.append(child)
            elif self.peek() == "variantSet":
                self.variants(prim)
            else:
                self.property(prim)
        self.take("}")

    def variants(self, prim):
        self.take("variantSet")
        name = self.string()
        assert name not in prim.variants
        of = prim.variants[name] = {}
        self.take("=")
        self.take("{")
        while self.peek() != "}":
            variant = self.string()
            assert variant not in of
            of[variant] = Prim("variant", "", prim.name, {})
            self.body(of[variant])
        self.take("}")

    def property(self, prim):
        if self.peek() == "uniform":
            self.take()
        kind, name = self.take("word"), self.take("word")
        assert name not in prim.types, name
        prim.types[name] = kind
        if self.peek() == "=":
            self.take("=")
            prim.values[name] = self.value()
        prim.properties[name] = self.metadata()


def read_usda(text):
    """The layer's metadata and its only root."""
    parser = Parser(text)
    metadata = parser.metadata()
    root = parser.prim()
    assert parser.peek() is None
    return metadata, root
