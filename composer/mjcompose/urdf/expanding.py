"""Runs in a confined process: xacro makes the text of a URDF and reads files through the door, but evaluates nothing.

xacro evaluates `${…}` as Python without builtins, which does not confine it: attributes lead from any value to all of
Python. So each expansion replaces this evaluation by `evaluating.py`, and closes all other ways of xacro to evaluate
text. It does not read the environment.
"""

from __future__ import annotations

import io
import keyword
import os
import re
import sys
import traceback
import unicodedata
from collections.abc import Callable, Iterator, Mapping
from types import SimpleNamespace, TracebackType
from typing import Any
from xml.dom import expatbuilder, minidom

from mjcompose.base.access import Door
from mjcompose.base.files import Refused
from mjcompose.urdf.evaluating import Evaluator, Space, Stopped, XacroFunction, offered

BEFORE = ("xacro", "xacro.substitution_args", "yaml")
"""Modules that the process imports before it is confined: they may load libraries of the system."""
_PLACE = "mjcompose"
_RECURSION = 3000
_LONGEST = 200_000
"""The most characters of a text with values: xacro takes quadratic time."""


def expand(argument: dict[str, Any]) -> dict[str, Any]:
    """Return the text of an expanded template with the place of each element, or its fault."""
    _forget()
    try:
        import xacro
        from xacro import substitution_args
    except ImportError:
        return {"missing": True}
    work = _Work(xacro, Door(tuple(argument["roots"]), sees_all=argument["sees_all"]), argument)
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(_RECURSION)
    try:
        lacks = work.take_over(substitution_args)
        if lacks:
            return {"other": lacks}
        return work.expanded()
    finally:
        sys.setrecursionlimit(before)
        _forget()


def _forget() -> None:
    """Let the next import of xacro start again: expansions share nothing."""
    for name in [each for each in sys.modules if each.partition(".")[0] == "xacro"]:
        del sys.modules[name]


_HOOKS = tuple(
    "safe_eval eval_text eval_all eval_extension is_valid_name parse warning get_include_files load_yaml"
    " abs_filename_spec parse_macro_arg re_macro_arg YamlDictWrapper YamlListWrapper NameSpace".split()
)
_SUBSTITUTIONS = ("_eval", "_eval_find", "_eval_env", "_eval_optenv", "convert_value")
"""Names that are used or replaced in xacro: a version without one of them may evaluate differently."""


class _Work:
    def __init__(self, xacro: Any, door: Door, argument: dict[str, Any]) -> None:
        self.xacro = xacro
        self.door = door
        self.path: str = argument["path"]
        self.packages: dict[str, str] = argument["packages"]
        self.arguments: dict[str, str] = argument["arguments"]
        self.most: int = argument["elements"]
        self.files: list[str] = []
        self.known_arguments: set[str] = set()
        self.warnings: list[tuple[str, str]] = []
        self.count = 0

    def take_over(self, substitution: Any) -> str | None:
        """Replace the functions of xacro that evaluate or reach outside; return the name of a missing one."""
        xacro = self.xacro
        for module, names in ((xacro, _HOOKS), (substitution, _SUBSTITUTIONS)):
            for name in names:
                if not hasattr(module, name):
                    return name
        parsed = _with_ends(xacro.parse_macro_arg, xacro.re_macro_arg.pattern)
        if parsed is None:
            return "re_macro_arg"
        xacro.parse_macro_arg = parsed
        for module in (xacro, substitution):
            for name in ("eval", "exec", "compile", "open"):
                setattr(module, name, _no_way)
        self.evaluator = Evaluator(
            (xacro.YamlDictWrapper,), (xacro.YamlListWrapper,), lambda value: type(value) is xacro.NameSpace
        )
        self.substitution = substitution
        vars(xacro).update(
            _global_symbols=self.symbols(xacro._global_symbols),
            open=self.opened,
            parse=self.parse,
            glob=SimpleNamespace(glob=self.globbed),
            warning=self.warned,
            safe_eval=self.evaluated,
            eval_text=self.bounded(xacro.eval_text),
            eval_all=self.counted(xacro.eval_all),
            eval_extension=self.extension(xacro.eval_extension),
            is_valid_name=_is_name,
        )
        vars(substitution).update(
            _eval=self.substituted,
            _eval_find=self.found,
            _eval_env=self.environment,
            _eval_optenv=lambda name, default="": default,
        )
        return None

    def symbols(self, own: Mapping[str, Any]) -> dict[str, Any]:
        """Return the meaning of names in expressions: all of xacro's names, each with its replacement."""
        xacro = self.xacro
        tools = self.evaluator
        functions = tools.functions() | {"True": True, "False": False}
        mathematics = tools.mathematics()
        special: dict[str, Callable[..., Any]] = {
            "load_yaml": lambda filename: xacro.load_yaml(filename),
            "abs_filename": xacro.abs_filename_spec,
            "dotify": xacro.YamlDictWrapper,
            "arg": self.argument,
            "tokenize": tools.tokenized,
            "message": lambda *words, **_: "",
            "print_location": lambda *words, **_: "",
            "warning": self.told,
            "error": self.told,
            "fatal": self.fatal,
        }
        ours = {name: XacroFunction(name, apply) for name, apply in special.items()}
        spaces = {"python": functions, "math": mathematics, "xacro": ours}
        found = offered(own, functions | mathematics | ours)
        for name, entries in spaces.items():
            if name in own:
                found[name] = Space(name, offered(dict.keys(own[name]), entries))
        return found

    def evaluated(self, expression: str, names: Any, _: Any = None) -> Any:
        """Replaces `safe_eval`."""
        return self.evaluator.value(expression, names.__getitem__)

    def substituted(self, expression: str, context: Mapping[str, Any]) -> str:
        """Replaces the evaluation of `$(eval …)`, whose names are functions, then arguments."""
        known = {
            **self.evaluator.functions(),
            **self.evaluator.mathematics(),
            "true": True,
            "false": False,
            "find": XacroFunction("find", self.found),
            "env": XacroFunction("env", self.environment),
            "optenv": XacroFunction("optenv", lambda name, default="": default),
            "arg": XacroFunction("arg", lambda name: self.substitution.convert_value(self.argument(name), "auto")),
            "dirname": XacroFunction("dirname", lambda: self.folder()),
        }
        arguments = context.get("arg", {})

        def named(name: str) -> Any:
            if name in known:
                return known[name]
            value = arguments[name]
            self.known_arguments.add(name)
            return self.substitution.convert_value(value, "auto")

        return str(self.evaluator.value(expression, named))

    def argument(self, name: str) -> Any:
        self.known_arguments.add(name)
        known = self.xacro.substitution_args_context["arg"]
        if name not in known:
            raise Stopped("argument", f"the argument `{name}` of the template has no value", name)
        return known[name]

    def folder(self) -> str:
        return os.path.dirname(os.path.abspath(str(self.xacro.filestack[-1])))

    def told(self, *words: Any, **_: Any) -> str:
        self.warned(*words)
        return ""

    def fatal(self, *words: Any) -> None:
        raise self.xacro.XacroException(" ".join(map(str, words)))

    def bounded(self, evaluate: Callable[..., Any]) -> Callable[..., Any]:
        def text_of(text: str, symbols: Any) -> Any:
            if len(text) > _LONGEST and "$" in text:
                raise Stopped("costly", f"a text with values in it has at most {_LONGEST} characters")
            value = evaluate(text, symbols)
            if isinstance(value, str) and len(value) > max(_LONGEST, len(text)):
                raise Stopped("costly", f"a text that values make has at most {_LONGEST} characters")
            return value

        return text_of

    def expanded(self) -> dict[str, Any]:
        try:
            self.xacro.init_stacks(self.path)
            document = self.parse(None, self.path)
            self.xacro.process_doc(document, mappings=dict(self.arguments))
        except Exception as error:
            return self.failed(error)
        root = document.documentElement
        places = [self.placed(each.getUserData(_PLACE)) for each in _elements(root)]
        return {
            "text": root.toxml(),
            "places": places,
            "files": self.files,
            "warnings": self.warnings,
            "unused": sorted(self.arguments.keys() - self.known_arguments),
            "arguments": sorted(self.known_arguments),
        }

    def placed(self, place: tuple[str, int, int, str] | None) -> list[Any]:
        file, *rest = place or (self.path, 1, 0, "")
        self.has_read(file)
        return [self.files.index(file), *rest]

    def has_read(self, path: str) -> None:
        if path not in self.files:
            self.files.append(path)

    def failed(self, error: Exception) -> dict[str, Any]:
        """Return the fault, at the innermost element in progress, and the macro calls that led there."""
        frames = list(_frames(error.__traceback__))
        trail = (_place_of(frame.f_locals.get(name)) for frame in frames for name in ("node", "elt", "tag"))
        at = getattr(error, "at", None) or next((place for place in [*trail][::-1] if place is not None), None)
        macros = (frame for frame in frames if frame.f_code.co_name == "handle_macro_call")
        places = (_place_of(frame.f_locals.get("node")) for frame in macros)
        calls = [place for place in places if place is not None and place != at]
        fault = {
            **self.reason(error),
            "at": None if at is None else self.placed(at),
            "calls": [self.placed(call) for call in reversed(calls)][:5],
        }
        return {"error": fault, "files": self.files}

    def reason(self, error: Exception) -> dict[str, Any]:
        """Return code, message, subject and known names of an error, by its innermost cause."""
        cause = _innermost(error)
        message = " ".join(str(error).split()) or type(error).__name__
        reason = {"code": "xacro", "message": message, "subject": "", "known": None}
        if isinstance(cause, Stopped):
            return reason | {"code": cause.code, "message": str(cause), "subject": cause.subject}
        if isinstance(cause, OSError) and cause.filename:
            why = (cause.strerror or "unreadable").lower()
            return reason | {"code": "file", "message": why, "subject": str(cause.filename)}
        unknown = _unknown(cause)
        if unknown is not None:
            code, subject, known = unknown
            return reason | {"code": code, "subject": subject, "known": known}
        if isinstance(cause, RecursionError):
            return reason | {"message": "macros or properties refer to each other without an end"}
        if not isinstance(error, (self.xacro.XacroException, RuntimeError, Stopped)):
            traceback.print_exception(error)
            return reason | {"message": f"{type(error).__name__}: {message}"}
        return reason

    def opened(self, name: str, *_: Any, **__: Any) -> io.StringIO:
        path = os.path.abspath(os.path.join(os.path.dirname(self.path), name))
        return io.StringIO(self.read(path).decode("utf-8-sig"))

    def read(self, path: str) -> bytes:
        try:
            data = self.door.read(path)
        except Refused as refused:  # no OSError, which xacro ignores for an optional file
            raise Stopped("refused", refused.message(), path) from refused
        self.has_read(path)
        return data

    def parse(self, given: Any, filename: str | None = None) -> Any:
        if given is not None or filename is None:
            return given
        path = os.path.abspath(os.path.join(os.path.dirname(self.path), filename))
        try:
            data = self.read(path)
        except OSError as error:
            if self.xacro.filestack and len(self.xacro.filestack) > 1:
                self.xacro.filestack.pop()  # an optional include continues
            raise self.xacro.XacroException(str(error.strerror), exc=error) from error
        return _parsed(data, path)

    def globbed(self, pattern: str) -> list[str]:
        """Return the files of a pattern; a pattern outside the readable folders is an error."""
        try:
            return self.door.search(os.path.abspath(pattern))
        except Refused as refused:
            raise Stopped("refused", refused.message(), refused.path) from refused

    def warned(self, *words: Any, **_: Any) -> None:
        text = " ".join(str(each) for each in words)
        if "deprecated" not in text:
            stack = self.xacro.filestack
            self.warnings.append((text, (stack and stack[-1]) or self.path))

    def counted(self, evaluate: Callable[..., Any]) -> Callable[..., Any]:
        def counting(node: Any, macros: Any, symbols: Any) -> Any:
            self.count += 1
            if self.count > self.most:
                raise Stopped("limit", f"the template makes more than {self.most} elements")
            for each in node.childNodes:
                if getattr(each, "tagName", "") == "xacro:arg":
                    self.known_arguments.add(each.getAttribute("name"))
            return evaluate(node, macros, symbols)

        return counting

    def extension(self, evaluate: Callable[..., Any]) -> Callable[..., Any]:
        def extended(text: str) -> Any:
            words = text[2:-1].split()
            if words[:1] == ["cwd"]:
                raise Stopped("environment", "`$(cwd)` depends on the folder in which the command runs", "cwd")
            if words[:1] == ["dirname"]:
                return self.folder()
            if words[:1] == ["arg"] and len(words) == 2:
                self.argument(words[1])
            return evaluate(text)

        return extended

    def found(self, name: str) -> str:
        folder = self.packages.get(name)
        if folder is None:
            raise Stopped("package", f"the package `{name}` is not known", name)
        return folder

    def environment(self, name: str) -> str:
        raise Stopped("environment", f"`$(env {name})` reads the environment variable `{name}`", name)


def _innermost(error: BaseException) -> BaseException:
    """Return the cause that xacro keeps in `exc` of its exceptions, and so on."""
    cause = getattr(error, "exc", None)
    while isinstance(cause, BaseException):
        error = cause
        cause = getattr(error, "exc", None)
    return error


def _unknown(error: BaseException) -> tuple[str, str, list[str]] | None:
    """Return the kind of a missing name, the name, and the names that exist; None for another error."""
    frames = list(_frames(error.__traceback__))
    if isinstance(error, NameError) and error.name:
        tables = [frame.f_locals["symbols"] for frame in frames if "symbols" in frame.f_locals]
        return None if not tables else ("property", error.name, _names(tables[-1]))
    last = frames[-1] if frames else None
    if last is None or last.f_code.co_name != "handle_macro_call" or "m" in last.f_locals:
        return None  # with `m` it has found the macro, and a parameter is wrong
    name = str(last.f_locals.get("name") or "")
    return None if not name else ("macro", name, _names(last.f_locals["macros"]))


def _names(table: Any) -> list[str]:
    """Return the names of a table of xacro and of the tables around it, without global ones such as `pi`."""
    found: set[str] = set()
    while hasattr(table, "parent"):
        found |= {str(name) for name in table if not str(name).startswith("__")}
        table = table.parent
    return sorted(found)


def _no_way(*_: Any, **__: Any) -> Any:
    raise Stopped("unsafe", "xacro evaluates something here in an unknown way")


def _with_ends(parse: Callable[[str], Any], pattern: str) -> Callable[[str], Any] | None:
    """Parse `params` as xacro does, but fail early for quotes without an end: xacro tries all ways to pair them."""
    steady = pattern.replace("'.*?'", "'[^']*'").replace('\\".*?\\"', '\\"[^\\"]*\\"').replace("]+)+", "]++)++")
    if ".*?'" in steady or "]++)++" not in steady:
        return None  # another version of xacro

    def parsed(text: str) -> Any:
        if re.match(r"\s*[^\s:=]+\s*:?=", text) and re.match(steady, text) is None and re.search("['\"]", text):
            raise Stopped("unsafe", "a quote in `params` has no end")
        return parse(text)

    return parsed


def _is_name(name: str) -> bool:
    """Replaces a function that parses the name as a program."""
    return name.isidentifier() and not keyword.iskeyword(name) and unicodedata.normalize("NFKC", name) == name


class _Builder(expatbuilder.ExpatBuilderNS):
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
    place: tuple[str, int, int, str] | None = None
    while node is not None and place is None:
        if getattr(node, "nodeType", None) == minidom.Node.ELEMENT_NODE:
            place = node.getUserData(_PLACE)
        node = getattr(node, "parentNode", None)
    return place


def _frames(trace: TracebackType | None) -> Iterator[Any]:
    while trace is not None:
        yield trace.tb_frame
        trace = trace.tb_next
