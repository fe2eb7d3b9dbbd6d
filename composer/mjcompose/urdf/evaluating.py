"""Expressions of xacro templates, evaluated step by step over their syntax tree.

In xacro they are Python. This module supports only the operators, functions and methods of this file, on numbers,
texts, lists and mappings; Python does not run any of them. Every other step or value is refused. Sizes are bounded
before the work.
"""

from __future__ import annotations

import ast
import datetime
import functools
import math
import operator
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from mjcompose.base.dataclass import Struct

LONGEST = 10_000
"""The most characters of an expression."""
DEEPEST = 100
"""The deepest nesting of an expression."""
STEPS = 500_000
"""The most steps of all expressions of a template."""
LARGEST = 200_000
"""The greatest length of one value."""
BITS = 4096
"""The most bits of an integer."""
Names = Callable[[str], Any]
"""Return the meaning of a name. Raises KeyError."""


class Stopped(Exception):
    """A forbidden step of a template: the `code` that the parent reports, and its `subject`."""

    def __init__(self, code: str, message: str, subject: str = "") -> None:
        super().__init__(message)
        self.code = code
        self.subject = subject


class XacroFunction(Struct, frozen=False, eq=False):
    """A function that expressions may call. It has no text."""

    name: str
    apply: Callable[..., Any]
    kind: type | None = None

    def __repr__(self) -> str:
        raise Stopped("unsafe", f"`{self.name}` is a function, not a value for a model", self.name)


class Space(Struct, frozen=False, eq=False):
    """The names after a name such as `math.`."""

    name: str
    entries: Mapping[str, Any]

    def __repr__(self) -> str:
        raise Stopped("unsafe", f"`{self.name}` is not a value for a model", self.name)


_SCALARS: tuple[type, ...] = (int, float, bool, type(None), datetime.date, datetime.datetime)
_MAPPINGS = (dict,)
_LISTS = (list, tuple)
_VIEWS: tuple[type, ...] = (type({}.keys()), type({}.values()), type({}.items()))
_BINARY: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.LShift: operator.lshift,
    ast.RShift: operator.rshift,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
}
_UNARY: Mapping[type, Callable[[Any], Any]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
    ast.Invert: operator.invert,
}
_COMPARISONS: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.In: lambda a, b: a in b,
    ast.NotIn: lambda a, b: a not in b,
}
METHODS: Mapping[type, frozenset[str]] = {
    str: frozenset(
        "capitalize count endswith find index isalnum isalpha isdecimal isdigit isidentifier islower isnumeric isspace"
        " istitle isupper join lower lstrip partition removeprefix removesuffix replace rfind rindex rpartition rsplit"
        " rstrip split splitlines startswith strip swapcase title upper zfill center ljust rjust".split()
    ),
    list: frozenset({"count", "index"}),
    tuple: frozenset({"count", "index"}),
    dict: frozenset({"get", "items", "keys", "values"}),
    float: frozenset({"is_integer"}),
}
"""Methods that expressions may call. None changes its value or exposes its parts."""
_FORMAT = re.compile(r"%(?:\([^()]*\))?[-+ #0]*\d{0,3}(?:\.\d{0,3})?[hlL]?[diouxXeEfFgGcrsa%]")
_SEPARATORS = re.compile(r"[^\\\[\]^-]+")


class Evaluator:
    """Evaluates the expressions of one template, which share a number of steps.

    `mappings` and `lists` are the classes that xacro makes from YAML; `is_namespace` recognizes the properties of an
    included file.
    """

    def __init__(
        self,
        mappings: Sequence[type] = (),
        lists: Sequence[type] = (),
        is_namespace: Callable[[Any], bool] = lambda value: False,
    ) -> None:
        self.steps = STEPS
        self._depth = 0
        self._inner: list[dict[str, Any]] = []
        self._names: Names = dict[str, Any]().__getitem__
        self._mappings = (*_MAPPINGS, *mappings)
        self._lists = (*_LISTS, *lists)
        self._is_namespace = is_namespace
        self._kinds = {*_SCALARS, str, bytes, range, *self._mappings, *self._lists, *_VIEWS, XacroFunction, Space}
        self._parsed = functools.lru_cache(2048)(self._tree)

    def value(self, text: str, names: Names) -> Any:
        """Evaluate an expression. Raises Stopped for forbidden steps, and otherwise the same errors as Python."""
        before = self._names, self._inner, self._depth  # a property is evaluated at its first use
        self._names = names
        self._inner = []
        self._depth = 0
        try:
            return self._of(self._parsed(text))
        finally:
            self._names, self._inner, self._depth = before

    def _tree(self, text: str) -> ast.expr:
        if len(text) > LONGEST:
            raise Stopped("unsafe", f"an expression has at most {LONGEST} characters")
        try:
            return ast.parse(text.strip(), "<expression>", "eval").body
        except SyntaxError:
            raise
        except Exception as error:
            raise Stopped("unsafe", f"the expression cannot be parsed: {type(error).__name__}") from None

    def _of(self, node: ast.expr) -> Any:
        step = _STEPS.get(type(node))
        if step is None:
            word = _WORDS.get(type(node), type(node).__name__)
            raise Stopped("unsafe", f"`{word}` is not allowed in an expression", word)
        self._depth += 1
        if self._depth > DEEPEST:
            raise Stopped("unsafe", f"an expression nests at most {DEEPEST} deep")
        self.spend(1)
        value = step(self, node)
        self._depth -= 1
        return value

    def spend(self, steps: int) -> None:
        self.steps -= steps
        if self.steps < 0:
            raise Stopped("costly", f"the expressions of the template take more than {STEPS} steps")

    def known(self, value: Any) -> Any:
        """Return a value of a known kind; its items were checked when it was made."""
        kind = type(value)
        if kind not in self._kinds and not self._is_namespace(value):
            raise Stopped("unsafe", f"an expression has no values of the kind `{kind.__name__}`")
        return value

    def admitted(self, value: Any) -> Any:
        """Return a value after checking its size and the kinds of all its items."""
        if type(value) not in (XacroFunction, Space) and not self._is_namespace(value):
            self.spend(self.weight(value) // 8)
        return value

    def weight(self, value: Any) -> int:
        """Return the number of characters and values in a value, at all depths."""
        count = 0
        waiting = [value]
        while waiting:
            each = waiting.pop()
            kind = type(each)
            count += 1
            if kind in (str, bytes) or kind is range:
                count += len(each)
            elif kind in self._mappings:
                waiting += [*dict.keys(each), *dict.values(each)]
            elif kind in self._lists:
                waiting += list.__iter__(each) if isinstance(each, list) else each
            elif kind in _VIEWS:
                waiting += each
            elif kind is int and each.bit_length() > BITS:
                raise Stopped("costly", f"a whole number has at most {BITS} bits")
            elif kind is complex:
                raise Stopped("unsafe", "the root of a negative number")
            elif kind not in _SCALARS and kind is not XacroFunction:
                raise Stopped("unsafe", f"an expression has no values of the kind `{kind.__name__}`")
            if count + len(waiting) > LARGEST:
                raise Stopped("costly", f"a value in an expression has more than {LARGEST} characters or items")
        return count

    # Steps, each of one kind of node.

    def _constant(self, node: ast.Constant) -> Any:
        return self.admitted(node.value)

    def _name(self, node: ast.Name) -> Any:
        name = _allowed(node.id)
        scope = next((names for names in reversed(self._inner) if name in names), None)
        if scope is not None:
            return scope[name]
        try:
            value = self._names(name)
        except KeyError:
            raise NameError(f"name '{name}' is not defined", name=name) from None
        return self._offered(name, value)

    def _offered(self, name: str, value: Any) -> Any:
        if value is _NOT_OFFERED:
            raise Stopped("unsafe", f"`{name}` is not allowed in an expression", name)
        return self.known(value)

    def _attribute(self, node: ast.Attribute) -> Any:
        value = self._of(node.value)
        name = _allowed(node.attr)
        if isinstance(value, Space):
            if name not in value.entries:
                raise NameError(f"name '{name}' is not defined")
            return self._offered(f"{value.name}.{name}", value.entries[name])
        kind = type(value)
        if self._is_namespace(value):
            if name in dir(kind) or name in vars(value):
                raise Stopped("unsafe", f"`.{name}` is not allowed in an expression", name)
            try:
                return self._offered(name, value[name])
            except KeyError:
                raise NameError(f"name '{name}' is not defined") from None
        plain = dict if kind in self._mappings else list if kind in self._lists[2:] else kind
        if name in METHODS.get(plain, ()):
            return XacroFunction(name, functools.partial(self._method, value, name))
        if kind in self._mappings[1:] and not hasattr(dict, name):
            return self.known(value[name])
        if plain in METHODS and not hasattr(plain, name):
            raise AttributeError(f"'{kind.__name__}' object has no attribute '{name}'")
        raise Stopped("unsafe", f"`.{name}` is not allowed in an expression", name)

    def _method(self, value: Any, name: str, *given: Any, **named: Any) -> Any:
        match name, given:
            case (("zfill" | "center" | "ljust" | "rjust"), (int() as most, *_)):
                _bounded(most)
            case "replace", (str() as old, str() as new, *_):
                _bounded(value.count(old) * len(new))
            case "join", (items, *_):
                _bounded(len(value) * len(items))
        return getattr(value, name)(*given, **named)

    def _call(self, node: ast.Call) -> Any:
        function = self._of(node.func)
        given: list[Any] = []
        for each in node.args:
            if isinstance(each, ast.Starred):
                given += self.items(self._of(each.value))
            elif isinstance(each, ast.GeneratorExp):  # elsewhere a generator is a value of another kind
                given.append(self._comprehension(each))
            else:
                given.append(self._of(each))
        named: dict[str, Any] = {}
        for keyword in node.keywords:
            value = self._of(keyword.value)
            if keyword.arg is None and type(value) not in self._mappings:
                raise TypeError("argument after ** must be a mapping")
            more = dict.items(value) if keyword.arg is None else [(keyword.arg, value)]
            named |= {_allowed(str(key)): item for key, item in more}
        return self.called(function, given, named)

    def called(self, function: Any, given: Sequence[Any], named: Mapping[str, Any]) -> Any:
        """Call a function. Native functions get only values of known kinds, and their work counts as steps."""
        if not isinstance(function, XacroFunction):
            raise TypeError(f"'{type(function).__name__}' object is not callable")
        for each in (*given, *named.values()):
            self.admitted(each)
        return self.admitted(function.apply(*given, **named))

    def items(self, value: Any) -> list[Any]:
        if type(value) not in (str, range, *self._mappings, *self._lists, *_VIEWS):
            raise TypeError(f"'{type(value).__name__}' object is not iterable")
        self.spend(len(value))
        return list(value)

    def _binary(self, node: ast.BinOp) -> Any:
        right: list[ast.BinOp] = []
        first: ast.expr = node
        while isinstance(first, ast.BinOp):  # a long sum leans to the left
            right.append(first)
            first = first.left
        value = self._of(first)
        for each in reversed(right):
            value = self._worked_out(type(each.op), value, self._of(each.right))
        return value

    def _worked_out(self, kind: type, one: Any, other: Any) -> Any:
        work = _BINARY.get(kind)
        if work is None:
            raise Stopped("unsafe", "`@` is not allowed in an expression", "@")
        self.spend(1)
        for operand in (one, other):
            if isinstance(operand, XacroFunction | Space) or self._is_namespace(operand):
                raise TypeError("unsupported operand")
        self._check_cost(kind, one, other)
        return self.admitted(work(one, other))

    def _check_cost(self, kind: type, one: Any, other: Any) -> None:
        """Raise Stopped if an operation of this kind would take very long, or make a very large value."""
        if kind is ast.Mult:
            for value, times in ((one, other), (other, one)):
                if isinstance(times, int) and not isinstance(value, int | float):
                    _bounded(self.weight(value) * max(times, 0))
        elif kind is ast.Pow and isinstance(one, int) and isinstance(other, int):
            if one.bit_length() * other > BITS:
                raise Stopped("costly", f"a whole number has at most {BITS} bits")
        elif kind is ast.LShift and isinstance(other, int):
            _bounded(other * LARGEST // BITS)
        elif kind is ast.Mod and isinstance(one, str):
            if "%" in _FORMAT.sub("", one):
                raise Stopped("unsafe", "this text is not a format for `%` in an expression", "%")
            _bounded(one.count("%") * self.weight(other))

    def _unary(self, node: ast.UnaryOp) -> Any:
        return self.admitted(_UNARY[type(node.op)](self._of(node.operand)))

    def _both(self, node: ast.BoolOp) -> Any:
        value = None
        for each in node.values:
            value = self._of(each)
            if bool(value) is isinstance(node.op, ast.Or):
                return value
        return value

    def _comparison(self, node: ast.Compare) -> Any:
        left = self._of(node.left)
        value = True
        for symbol, operand in zip(node.ops, node.comparators, strict=True):
            right = self._of(operand)
            self.admitted(left)  # a comparison reads both
            value = _COMPARISONS[type(symbol)](left, right)
            if not value:
                break
            left = right
        return value

    def _choice(self, node: ast.IfExp) -> Any:
        return self._of(node.body if self._of(node.test) else node.orelse)

    def _item(self, node: ast.Subscript) -> Any:
        value = self._of(node.value)
        if type(value) not in (str, range, *self._mappings, *self._lists):
            raise TypeError(f"'{type(value).__name__}' object is not subscriptable")
        if isinstance(node.slice, ast.Slice):
            ends = (node.slice.lower, node.slice.upper, node.slice.step)
            return self.admitted(value[slice(*(None if each is None else self._of(each) for each in ends))])
        return self.known(value[self._of(node.slice)])

    def _list(self, node: ast.List | ast.Tuple) -> Any:
        found: list[Any] = []
        for each in node.elts:
            found += self.items(self._of(each.value)) if isinstance(each, ast.Starred) else [self._of(each)]
        return self.admitted(found if isinstance(node, ast.List) else tuple(found))

    def _mapping(self, node: ast.Dict) -> Any:
        found: dict[Any, Any] = {}
        for key, value in zip(node.keys, node.values, strict=True):
            if key is None:
                raise Stopped("unsafe", "`**` is not allowed in a mapping", "**")
            found[self._of(key)] = self._of(value)
        return self.admitted(found)

    def _comprehension(self, node: ast.ListComp | ast.GeneratorExp) -> Any:
        return self.admitted([self._of(node.elt) for _ in self._rounds(node.generators)])

    def _mapping_of(self, node: ast.DictComp) -> Any:
        return self.admitted({self._of(node.key): self._of(node.value) for _ in self._rounds(node.generators)})

    def _rounds(self, generators: Sequence[ast.comprehension]) -> Iterator[None]:
        """Run the loops and conditions of a comprehension, with its names in scope."""
        if not generators:
            yield
            return
        first, *others = generators
        if first.is_async:
            raise Stopped("unsafe", "`async` is not allowed in an expression", "async")
        for item in self.items(self._of(first.iter)):
            scope: dict[str, Any] = {}
            self._assign(first.target, item, scope)
            self._inner.append(scope)
            if all(self._of(each) for each in first.ifs):
                yield from self._rounds(others)
            self._inner.pop()

    def _assign(self, target: ast.expr, value: Any, scope: dict[str, Any]) -> None:
        if isinstance(target, ast.Name):
            scope[_allowed(target.id)] = self.known(value)
        elif isinstance(target, ast.Tuple | ast.List):
            values = self.items(value)
            if len(values) != len(target.elts):
                raise ValueError(f"{len(target.elts)} names for {len(values)} values")
            for each, inner in zip(target.elts, values, strict=True):
                self._assign(each, inner, scope)
        else:
            raise Stopped("unsafe", "`for` takes only names")

    # The functions of xacro and of Python.

    def functions(self) -> dict[str, Any]:
        native: dict[str, tuple[Callable[..., Any], type | None]] = {
            "len": (len, None),
            "str": (self._text, str),
            "float": (float, float),
            "int": (int, int),
            "bool": (bool, bool),
            "round": (self._round, None),
            "abs": (abs, None),
            "all": (all, None),
            "any": (any, None),
            "divmod": (divmod, None),
            "ord": (ord, None),
            "repr": (repr, None),
            "sum": (sum, None),
            "range": (range, range),
            "dict": (dict, dict),
            "list": (lambda *value: list(*map(self.items, value)), list),
            "tuple": (lambda *value: tuple(*map(self.items, value)), tuple),
            "enumerate": (lambda value, start=0: list(enumerate(self.items(value), start)), None),
            "reversed": (lambda value: self.items(value)[::-1], None),
            "zip": (lambda *values: list(zip(*map(self.items, values), strict=False)), None),
            "map": (self._mapped, None),
            "filter": (self._filtered, None),
            "sorted": (functools.partial(self._ordered, sorted), None),
            "min": (functools.partial(self._ordered, min), None),
            "max": (functools.partial(self._ordered, max), None),
            "isinstance": (self._is_instance, None),
        }
        return {name: XacroFunction(name, apply, kind) for name, (apply, kind) in native.items()}

    def mathematics(self) -> dict[str, Any]:
        special: dict[str, Callable[..., Any]] = {
            "factorial": self._factorial,
            "prod": self._product,
            "comb": self._chosen,
            "perm": self._chosen,
        }
        return {
            name: each
            if isinstance(each, float)
            else XacroFunction(name, functools.partial(special[name], each) if name in special else each)
            for name, each in vars(math).items()
            if isinstance(each, float) or (callable(each) and not name.startswith("_"))
        }

    def _text(self, *value: Any) -> str:
        if len(value) > 1 or (value and type(value[0]) is XacroFunction):
            raise TypeError("`str` takes one value")
        return str(*value)

    def _round(self, value: Any, ndigits: Any = None) -> Any:
        if isinstance(ndigits, int) and abs(ndigits) > 400:
            raise Stopped("costly", "`round` keeps at most 400 digits")
        return round(value) if ndigits is None else round(value, ndigits)

    def _mapped(self, function: Any, first: Any, *others: Any) -> list[Any]:
        rows = zip(*map(self.items, (first, *others)), strict=False)
        return [self.called(function, each, {}) for each in rows]

    def _filtered(self, function: Any, values: Any) -> list[Any]:
        items = self.items(values)
        return [each for each in items if (each if function is None else self.called(function, (each,), {}))]

    def _ordered(self, work: Callable[..., Any], *values: Any, key: Any = None, **named: Any) -> Any:
        if key is not None:
            named["key"] = lambda value: self.called(key, (value,), {})
        return work(*values, **named)

    def _is_instance(self, value: Any, kinds: Any) -> bool:
        named = kinds if isinstance(kinds, tuple) else (kinds,)
        types = tuple(each.kind for each in named if isinstance(each, XacroFunction) and each.kind is not None)
        if len(types) != len(named):
            raise TypeError("isinstance() arg 2 must be a type or a tuple of types")
        return isinstance(value, types)

    def _factorial(self, work: Callable[..., Any], number: Any) -> Any:
        if isinstance(number, int) and number > 400:
            raise Stopped("costly", "`factorial` takes 400 at most")
        return work(number)

    def _chosen(self, work: Callable[..., Any], number: Any, of: Any = None) -> Any:
        for each in (number, of):
            if isinstance(each, int) and each > 1000:
                raise Stopped("costly", f"`{work.__name__}` takes 1000 at most")
        return work(number) if of is None else work(number, of)

    def _product(self, work: Callable[..., Any], values: Any, *, start: Any = 1) -> Any:
        for each in self.items(values):
            start = self.admitted(start * each) if isinstance(each, int | float) else work([each])
        return start

    def tokenized(self, text: Any, sep: Any = ",; ", skip_empty: Any = True) -> list[str]:
        """Split as xacro's `tokenize`, which makes a regular expression from the separators."""
        if _SEPARATORS.fullmatch(sep) is None:
            raise Stopped("unsafe", "`tokenize` takes characters without `\\`, `[`, `]`, `^` and `-`")
        found = re.split(f"[{sep}]", text)
        return [each for each in found if each] if skip_empty else found


class _NotOffered:
    def __repr__(self) -> str:
        raise Stopped("unsafe", "this name of xacro is not allowed in an expression")


_NOT_OFFERED = _NotOffered()


def offered(names: Iterable[str], given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the meaning of each name; names of xacro that are not in `given` are refused when used."""
    return {name: given.get(name, _NOT_OFFERED) for name in names}


def _allowed(name: str) -> str:
    if name.startswith("__"):
        raise Stopped("unsafe", f"`{name}` is not allowed in an expression", name)
    return name


def _bounded(size: int) -> None:
    if size > LARGEST:
        raise Stopped("costly", f"a value in an expression has more than {LARGEST} characters or items")


_STEPS: Mapping[type, Callable[[Evaluator, Any], Any]] = {
    ast.Constant: Evaluator._constant,
    ast.Name: Evaluator._name,
    ast.Attribute: Evaluator._attribute,
    ast.Call: Evaluator._call,
    ast.BinOp: Evaluator._binary,
    ast.UnaryOp: Evaluator._unary,
    ast.BoolOp: Evaluator._both,
    ast.Compare: Evaluator._comparison,
    ast.IfExp: Evaluator._choice,
    ast.Subscript: Evaluator._item,
    ast.List: Evaluator._list,
    ast.Tuple: Evaluator._list,
    ast.Dict: Evaluator._mapping,
    ast.ListComp: Evaluator._comprehension,
    ast.DictComp: Evaluator._mapping_of,
}
_WORDS: Mapping[type, str] = {
    ast.Lambda: "lambda",
    ast.Await: "await",
    ast.Yield: "yield",
    ast.YieldFrom: "yield",
    ast.NamedExpr: ":=",
    ast.JoinedStr: "f'…'",
    ast.Set: "{…}",
    ast.SetComp: "{… for …}",
    ast.GeneratorExp: "(… for …)",
    ast.Starred: "*",
}
