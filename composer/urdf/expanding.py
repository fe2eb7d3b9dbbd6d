"""Runs in the child process: xacro makes the text of a URDF, reads through the door, and evaluates nothing unsafe.

xacro evaluates what stands in `${…}` as Python without builtins, which is no sandbox: attributes lead from any value to
all that Python has. So an expression is looked through before it is evaluated, and what is not arithmetic on values is
refused. Nothing of the environment is read.
"""

from __future__ import annotations

import ast
import fnmatch
import io
import os
import traceback
from collections.abc import Callable, Iterator
from types import SimpleNamespace, TracebackType
from typing import Any
from xml.dom import expatbuilder, minidom

from composer.reading.door import Door
from composer.reading.refused import Refused

_PLACE = "mjcompose"
_FRAMES = frozenset(
    "gi_frame gi_code gi_yieldfrom cr_frame cr_code cr_await cr_origin ag_frame ag_code ag_await tb_frame tb_next "
    "f_back f_builtins f_code f_globals f_locals f_trace co_consts co_code format format_map mro".split()
)
"""Attributes without underscores that lead out of a value; `format` follows attributes that a text names."""
_LEAD_OUT = ("type", "vars")
"""What xacro offers as `python.NAME` and leads from a value to its class."""


class Stopped(Exception):
    """What xacro is not let do: `code` as the parent reports it, `subject` what it is about."""

    def __init__(self, code: str, message: str, subject: str = "") -> None:
        super().__init__(message)
        self.code, self.subject = code, subject


def expand(mujoco: Any, argument: dict[str, Any]) -> dict[str, Any]:
    """The text that a template stands for with the place of each element, or what is wrong with it and where."""
    try:
        import xacro
        from xacro import substitution_args
    except ImportError:
        return {"missing": True}
    work = _Work(xacro, Door(tuple(argument["roots"]), sees_all=argument["sees_all"]), argument)
    before = {module: dict(vars(module)) for module in (xacro, substitution_args)}
    python = dict(xacro._global_symbols.get("python", {}))
    defaults = dict(substitution_args._eval_dict)
    try:
        work.take_over(substitution_args)
        return work.expanded()
    finally:
        for module, names in before.items():
            for name in vars(module).keys() - names.keys():
                delattr(module, name)
            vars(module).update(names)
        xacro._global_symbols["python"].update(python)
        substitution_args._eval_dict.update(defaults)


class _Work:
    def __init__(self, xacro: Any, door: Door, argument: dict[str, Any]) -> None:
        self.xacro, self.door = xacro, door
        self.path: str = argument["path"]
        self.packages: dict[str, str] = argument["packages"]
        self.arguments: dict[str, str] = argument["arguments"]
        self.most: int = argument["elements"]
        self.files: list[str] = []
        self.asked: set[str] = set()
        self.warnings: list[tuple[str, str]] = []
        self.count = 0
        self.defaults: dict[str, str] = {}

    def take_over(self, substitution: Any) -> None:
        """Put this work's functions in the place of xacro's that reach outside."""
        xacro = self.xacro
        python = xacro._global_symbols.get("python")
        for name in _LEAD_OUT:
            dict.pop(python, name, None)
        xacro.open = self.opened
        xacro.glob = SimpleNamespace(glob=self.globbed)
        xacro.parse = self.parse
        xacro.warning = self.warned
        xacro.safe_eval = self.guarded(xacro.safe_eval)
        xacro.eval_all = self.counted(xacro.eval_all)
        xacro.eval_extension = self.extension(xacro.eval_extension)
        substitution.eval = self.guarded(eval)
        substitution._eval_find = self.found
        substitution._eval_env = self.environment
        substitution._eval_optenv = lambda name, default="": default
        substitution._eval_dict.update(
            find=self.found, env=self.environment, optenv=lambda name, default="": default
        )

    def expanded(self) -> dict[str, Any]:
        xacro = self.xacro
        mappings = dict(self.arguments)
        names = set(mappings)
        try:
            xacro.init_stacks(self.path)
            document = self.parse(None, self.path)
            xacro.process_doc(document, mappings=mappings)
        except Exception as error:
            return self.failed(error)
        unused = sorted(names - self.declared())
        root = document.documentElement
        places = [each.getUserData(_PLACE) for each in _elements(root)]
        return {
            "text": root.toxml(),
            "places": [self.placed(place) for place in places],
            "files": self.files,
            "warnings": self.warnings,
            "unused": unused,
            "arguments": sorted(self.declared()),
        }

    def declared(self) -> set[str]:
        return self.asked

    def placed(self, place: tuple[str, int, int, str] | None) -> list[Any]:
        file, line, column, tag = place or (self.path, 1, 0, "")
        if file not in self.files:
            self.files.append(file)
        return [self.files.index(file), line, column, tag]

    def failed(self, error: Exception) -> dict[str, Any]:
        """What went wrong, at the innermost element that was worked on, and the calls of macros that led there."""
        inner: BaseException = error
        while (cause := getattr(inner, "exc", None)) is not None and isinstance(cause, BaseException):
            inner = cause
        trail: list[tuple[str, int, int, str]] = []
        for frame in _frames(error.__traceback__):
            for name in ("node", "elt", "tag"):
                place = _place_of(frame.f_locals.get(name))
                if place is not None and (not trail or trail[-1] != place):
                    trail.append(place)
        at = getattr(error, "at", None) or (trail[-1] if trail else None)
        calls = [
            place
            for frame in _frames(error.__traceback__)
            if frame.f_code.co_name == "handle_macro_call"
            and (place := _place_of(frame.f_locals.get("node"))) is not None
            and place != at
        ]
        code, subject, known = "xacro", "", None
        message = " ".join(str(error).split()) or type(error).__name__
        if isinstance(inner, Stopped):
            code, subject, message = inner.code, inner.subject, str(inner)
        elif isinstance(inner, OSError) and inner.filename:
            code, subject, message = "file", str(inner.filename), (inner.strerror or "unreadable").lower()
        elif (found := _unknown(inner)) is not None:
            code, subject, known = found
        elif isinstance(inner, RecursionError):
            message = "macros or properties lead to one another without an end"
        elif not isinstance(error, (self.xacro.XacroException, RuntimeError, Stopped)):
            traceback.print_exception(error)
            message = f"{type(error).__name__}: {message}"
        return {
            "error": {
                "code": code,
                "message": message,
                "subject": subject,
                "known": known,
                "at": None if at is None else self.placed(at),
                "calls": [self.placed(each) for each in reversed(calls)][:5],
            },
            "files": self.files,
        }

    # What stands in for xacro's own functions.

    def opened(self, name: str, *_: Any, **__: Any) -> io.StringIO:
        """A file as text, as the door lets it through."""
        path = os.path.abspath(os.path.join(os.path.dirname(self.path), name))
        data = self.read(path)
        return io.StringIO(data.decode("utf-8-sig"))

    def read(self, path: str) -> bytes:
        try:
            data = self.door.read(path)
        except (
            Refused
        ) as refused:  # no OSError for xacro, which passes over an optional file that cannot be read
            raise Stopped("refused", refused.message(), path) from refused
        if path not in self.files:
            self.files.append(path)
        return data

    def parse(self, given: Any, filename: str | None = None) -> Any:
        if given is not None or filename is None:
            return given
        path = os.path.abspath(os.path.join(os.path.dirname(self.path), filename))
        try:
            data = self.read(path)
        except OSError as error:
            if self.xacro.filestack and len(self.xacro.filestack) > 1:
                self.xacro.filestack.pop()  # so that an include that is optional goes on
            raise self.xacro.XacroException(str(error.strerror), exc=error) from error
        return _parsed(data, path)

    def globbed(self, pattern: str) -> list[str]:
        folder, name = os.path.split(pattern)
        if not self.door.sees(folder) or not os.path.isdir(folder):
            return []
        return [
            os.path.join(folder, each) for each in sorted(os.listdir(folder)) if fnmatch.fnmatch(each, name)
        ]

    def warned(self, *words: Any, **_: Any) -> None:
        text = " ".join(str(each) for each in words)
        if "deprecated" not in text:
            stack = self.xacro.filestack
            self.warnings.append((text, (stack and stack[-1]) or self.path))

    def guarded(self, evaluate: Callable[..., Any]) -> Callable[..., Any]:
        def safe(expression: str, *scopes: Any) -> Any:
            check_expression(expression)
            return evaluate(expression, *scopes)

        return safe

    def counted(self, evaluate: Callable[..., Any]) -> Callable[..., Any]:
        def counting(node: Any, macros: Any, symbols: Any) -> Any:
            self.count += 1
            if self.count > self.most:
                raise Stopped("limit", f"the template makes more than {self.most} elements")
            for each in node.childNodes:
                if getattr(each, "tagName", "") == "xacro:arg":
                    self.asked.add(each.getAttribute("name"))
            return evaluate(node, macros, symbols)

        return counting

    def extension(self, evaluate: Callable[..., Any]) -> Callable[..., Any]:
        def extended(text: str) -> Any:
            words = text[2:-1].split()
            if words[:1] == ["cwd"]:
                raise Stopped(
                    "environment", "`$(cwd)` is the folder in which a command happens to run", "cwd"
                )
            if words[:1] == ["dirname"]:
                return os.path.dirname(os.path.abspath(str(self.xacro.filestack[-1])))
            if words[:1] == ["arg"] and len(words) == 2:
                known = self.xacro.substitution_args_context["arg"]
                self.asked.add(words[1])
                if words[1] not in known:
                    raise Stopped(
                        "argument", f"the argument `{words[1]}` of the template has no value", words[1]
                    )
            return evaluate(text)

        return extended

    def found(self, name: str) -> str:
        folder = self.packages.get(name)
        if folder is None:
            raise Stopped("package", f"the package `{name}` is not known", name)
        return folder

    def environment(self, name: str) -> str:
        raise Stopped("environment", f"`$(env {name})` reads the environment variable `{name}`", name)


def _unknown(error: BaseException) -> tuple[str, str, list[str]] | None:
    """The kind of a name that does not exist, the name, and those that do; None for another error."""
    frames = list(_frames(error.__traceback__))
    if isinstance(error, NameError) and error.name:
        tables = [frame.f_locals["symbols"] for frame in frames if "symbols" in frame.f_locals]
        return None if not tables else ("property", error.name, _names(tables[-1]))
    last = frames[-1] if frames else None
    if last is None or last.f_code.co_name != "handle_macro_call" or "m" in last.f_locals:
        return None  # with `m` it has found the macro, and stumbles over a parameter
    name = str(last.f_locals.get("name") or "")
    return None if not name else ("macro", name, _names(last.f_locals["macros"]))


def _names(table: Any) -> list[str]:
    """The names of a table of xacro and of those around it, without those that are everywhere, such as `pi`."""
    found: set[str] = set()
    while hasattr(table, "parent"):
        found |= {str(name) for name in table if not str(name).startswith("__")}
        table = table.parent
    return sorted(found)


def check_expression(text: str) -> None:
    """Refuse an expression that may do more than calculate. Raises Stopped.

    >>> check_expression("2 * pi + sin(x) if y else joint.limits['lower']")
    >>> check_expression("().__class__")
    Traceback (most recent call last):
    composer.urdf.expanding.Stopped: `__class__` is not allowed in an expression
    """
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError):
        return  # which is said where it is evaluated
    for node in ast.walk(tree):
        name = getattr(node, "attr", None) or getattr(node, "id", None) or getattr(node, "arg", None)
        if isinstance(name, str) and (
            name.startswith("__") or (isinstance(node, ast.Attribute) and _leads_out(name))
        ):
            raise Stopped("unsafe", f"`{name}` is not allowed in an expression", name)
        if isinstance(node, ast.Await | ast.Yield | ast.YieldFrom):
            raise Stopped("unsafe", "only values are allowed in an expression")


def _leads_out(name: str) -> bool:
    return name.startswith("_") or name in _FRAMES


class _Builder(expatbuilder.ExpatBuilderNS):
    """Builds a document whose elements know their places."""

    def __init__(self, path: str) -> None:
        super().__init__()
        self._path = path

    def start_element_handler(self, name: str, attributes: Any) -> None:
        super().start_element_handler(name, attributes)
        parser: Any = self.getParser()
        element: Any = self.curNode
        place = (self._path, parser.CurrentLineNumber, parser.CurrentColumnNumber, element.tagName)
        element.setUserData(_PLACE, place, _Carrier)

    def start_doctype_decl_handler(self, *_: Any) -> None:
        raise Stopped("unsafe", "a document type is not allowed")


class _Carrier:
    """Gives a copy of an element the place of the original."""

    @staticmethod
    def handle(operation: int, key: str, data: Any, source: Any, copy: Any) -> None:
        if copy is not None:
            copy.setUserData(key, data, _Carrier)


def _parsed(data: bytes, path: str) -> Any:
    from xml.parsers.expat import ErrorString, ExpatError

    builder = _Builder(path)
    try:
        return builder.parseString(data)
    except ExpatError as error:
        fault = Stopped("syntax", f"the file is not well-formed XML: {ErrorString(error.code)}")
        fault.at = (path, error.lineno, error.offset, "")  # type: ignore[attr-defined]
        raise fault from error


def _elements(node: Any) -> Iterator[Any]:
    yield node
    for child in node.childNodes:
        if child.nodeType == minidom.Node.ELEMENT_NODE:
            yield from _elements(child)


def _place_of(node: Any) -> tuple[str, int, int, str] | None:
    while node is not None:
        if getattr(node, "nodeType", None) == minidom.Node.ELEMENT_NODE:
            place: tuple[str, int, int, str] | None = node.getUserData(_PLACE)
            if place is not None:
                return place
        node = getattr(node, "parentNode", None)
    return None


def _frames(trace: TracebackType | None) -> Iterator[Any]:
    while trace is not None:
        yield trace.tb_frame
        trace = trace.tb_next
