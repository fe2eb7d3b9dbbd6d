"""`dataclass` of the standard library, made cheap to define: a class gets its `__init__` when it is first called.

The standard library compiles six functions for each frozen dataclass. This one compiles one, and only for a class that
is called; the other methods are shared. `fields`, `replace` and `asdict` of `dataclasses` work on these classes.
`Struct` is the base of most of them, without a decorator.

Defining 300 frozen classes takes 10 ms, 190 ms with the standard library and 4 ms with `msgspec.Struct` 0.22, whose
import takes 12 ms more (Python 3.11, processor time). It makes an object in 0.09 us instead of 0.63. It lacks `init`,
`repr` and `compare` of a field (35 uses), those functions of `dataclasses` (about 320 calls), a required field behind
the optional ones of a base, `cached_property` without a `__dict__` in each object (14 classes), and a `__post_init__`
that sets a field of a frozen object.

    >>> @dataclass(frozen=True, slots=True)
    ... class Pair:
    ...     first: int
    ...     second: int = 2
    >>> Pair(1)
    Pair(first=1, second=2)
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, FrozenInstanceError
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn, dataclass_transform

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
    from inspect import Signature

    @dataclass_transform(frozen_default=True, field_specifiers=(dataclasses.field, Field))
    class Struct:
        __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

        def __init_subclass__(
            cls, *, frozen: bool = True, slots: bool = True, eq: bool = True, kw_only: bool = False
        ) -> None: ...

else:

    def dataclass(
        cls: type | None = None, /, *, frozen: bool = False, slots: bool = False, eq: bool = True, kw_only: bool = False
    ) -> Any:
        """Return the class as a dataclass. The options are the options of the standard library."""

        def made(cls: type) -> type:
            if isinstance(cls, _StructType):
                raise TypeError(f"{cls.__name__} is a Struct: write the options of `dataclass` behind its bases")
            own = _own_fields(cls.__annotations__, cls.__dict__, kw_only)
            if slots:
                cls = _with_slots(cls, own)
            else:
                _set_defaults(cls, own)
            _add_methods(cls, own, frozen, slots=slots, eq=eq)
            return cls

        return made if cls is None else made(cls)


def _own_fields(annotations: Mapping[str, object], members: Mapping[str, Any], kw_only: bool) -> dict[str, Field[Any]]:
    fields = {}
    for name, annotation in annotations.items():
        if "ClassVar" in str(annotation).partition("[")[0]:
            continue
        default = members.get(name, MISSING)
        field: Any = default if isinstance(default, Field) else dataclasses.field(default=default)
        field.name = name
        field.type = annotation
        if field.kw_only is MISSING:
            field.kw_only = kw_only
        field._field_type = dataclasses._FIELD  # type: ignore[attr-defined]  # else `fields` leaves it out
        fields[name] = field
    return fields


def _with_slots(cls: type, own: dict[str, Field[Any]]) -> type:
    """Return a copy of the class that has slots: Python sets them only when it creates a class."""
    slotted = type(cls)(cls.__name__, cls.__bases__, _slotted(cls.__bases__, cls.__dict__, own))
    slotted.__qualname__ = cls.__qualname__
    return slotted


def _slotted(bases: tuple[type, ...], members: Mapping[str, Any], own: dict[str, Field[Any]]) -> dict[str, Any]:
    """Return the members of a class with slots for its fields, which have no values in the class."""
    without = {*own, "__dict__", "__weakref__"}
    kept = {name: value for name, value in members.items() if name not in without}
    inherited = {slot for base in bases for each in base.__mro__ for slot in getattr(each, "__slots__", ())}
    return {**kept, "__slots__": tuple(name for name in own if name not in inherited)}


def _set_defaults(cls: type, own: dict[str, Field[Any]]) -> None:
    for name, field in own.items():
        if field.default is not MISSING:
            setattr(cls, name, field.default)
        elif name in cls.__dict__:
            delattr(cls, name)


def _add_methods(cls: Any, own: dict[str, Field[Any]], frozen: bool, slots: bool, eq: bool) -> None:
    fields: dict[str, Field[Any]] = {}
    for base in cls.__mro__[:0:-1]:
        fields.update(base.__dict__.get("__dataclass_fields__", {}))
    fields.update(own)
    defined = frozenset(cls.__dict__)
    cls.__dataclass_fields__ = fields
    positional = (name for name, field in fields.items() if field.init and not field.kw_only)
    cls.__match_args__ = tuple(positional)  # type: ignore[misc]  # mypy knows the name from class bodies alone
    if "__init__" not in defined:
        cls.__init__ = _init_when_called(cls, frozen)
        cls.__signature__ = _Signature()
    if "__repr__" not in defined:
        cls.__repr__ = _repr
    if eq:
        is_equal, hashed = _comparing(tuple(name for name, field in fields.items() if field.compare))
        if "__eq__" not in defined:
            cls.__eq__ = is_equal
        if cls.__dict__.get("__hash__") is None:
            cls.__hash__ = hashed if frozen else None
    if frozen:
        cls.__setattr__ = _refuse_to_set
        cls.__delattr__ = _refuse_to_delete
        if slots and "__getstate__" not in defined:
            cls.__getstate__ = _state
            cls.__setstate__ = _set_state


def _init_when_called(cls: Any, frozen: bool) -> Callable[..., None]:
    """Return an `__init__` that replaces itself by the compiled one, then calls it."""

    def init(self: object, *arguments: object, **named: object) -> None:
        cls.__init__ = _init(cls, frozen)
        cls.__init__(self, *arguments, **named)

    init.__made__ = True  # type: ignore[attr-defined]
    return init


class _Signature:
    """The parameters that `help` and `inspect.signature` show, even for a class that was not called yet."""

    def __get__(self, _: object, cls: Any) -> Signature:
        from inspect import signature

        if not hasattr(cls.__init__, "__made__"):
            raise AttributeError("__signature__")  # the class has an `__init__` of its own
        init = _init(cls, frozen=False)
        init.__annotations__ = {name: field.type for name, field in cls.__dataclass_fields__.items() if field.init}
        whole = signature(init)
        return whole.replace(parameters=[*whole.parameters.values()][1:])


def _init(cls: Any, frozen: bool) -> Callable[..., None]:
    """Return the `__init__` of a class, compiled from text as in the standard library: nothing else is as fast."""
    missing = dataclasses._HAS_DEFAULT_FACTORY  # type: ignore[attr-defined]  # which is shown as `<factory>`
    known: dict[str, Any] = {"__set": object.__setattr__, "__missing": missing}
    positional: list[str] = []
    named: list[str] = []
    lines: list[str] = []
    for name, field in cls.__dataclass_fields__.items():
        value = name
        parameter = name
        if field.default_factory is not MISSING:
            known[f"__make_{name}"] = field.default_factory
            parameter = f"{name}=__missing"
            value = f"__make_{name}() if {name} is __missing else {name}" if field.init else f"__make_{name}()"
        elif field.default is not MISSING:
            known[f"__default_{name}"] = field.default
            parameter = f"{name}=__default_{name}"
            value = name if field.init else f"__default_{name}"
        elif not field.init:
            continue
        if field.init:
            (named if field.kw_only else positional).append(parameter)
        lines.append(f"__set(self, {name!r}, {value})" if frozen else f"self.{name} = {value}")
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    parameters = ", ".join(["self", *positional, *(["*", *named] if named else [])])
    text = f"def __init__({parameters}):\n " + ("\n ".join(lines) or "pass")
    exec(text, known)  # nosec B102  # the text has names from bodies of classes, nothing that was read
    init: Callable[..., None] = known["__init__"]
    init.__made__ = True  # type: ignore[attr-defined]
    init.__qualname__ = f"{cls.__qualname__}.__init__"
    return init


def _comparing(names: tuple[str, ...]) -> tuple[Callable[[Any, Any], Any], Callable[[Any], int]]:
    values: Callable[[Any], Any] = attrgetter(*names) if names else lambda _: ()

    def is_equal(self: Any, other: Any) -> Any:
        return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

    return is_equal, lambda self: hash(values(self))


@recursive_repr()
def _repr(self: Any) -> str:
    shown = (field for field in self.__dataclass_fields__.values() if field.repr)
    return f"{type(self).__qualname__}({', '.join(f'{field.name}={getattr(self, field.name)!r}' for field in shown)})"


def _refuse_to_set(self: object, name: str, value: object) -> NoReturn:
    raise FrozenInstanceError(f"cannot assign to field {name!r}")


def _refuse_to_delete(self: object, name: str) -> NoReturn:
    raise FrozenInstanceError(f"cannot delete field {name!r}")


def _state(self: Any) -> list[Any]:
    """Return the values of a frozen object with slots; copies and pickles cannot set them one by one."""
    return [getattr(self, name) for name in self.__dataclass_fields__]


def _set_state(self: Any, state: list[Any]) -> None:
    for name, value in zip(self.__dataclass_fields__, state, strict=True):
        object.__setattr__(self, name, value)


if not TYPE_CHECKING:

    class _StructType(type):
        def __new__(
            mcs, *made: Any, frozen: bool = True, slots: bool = True, eq: bool = True, kw_only: bool = False
        ) -> type:
            name, bases, members = made
            if not bases:  # `Struct` itself
                made = name, bases, {**members, "__slots__": (), "__dataclass_fields__": {}}
                return super().__new__(mcs, *made)
            own = _own_fields(members.get("__annotations__", {}), members, kw_only)
            made = name, bases, _slotted(bases, members, own) if slots else members
            cls = super().__new__(mcs, *made)
            if not slots:
                _set_defaults(cls, own)
            _add_methods(cls, own, frozen, slots=slots, eq=eq)
            return cls

        def __init__(cls, *made: Any, **options: bool) -> None:
            super().__init__(*made)

    class Struct(metaclass=_StructType):
        """The base of a frozen dataclass with slots; the options of `dataclass` follow it in the header of a class.

        >>> class Pair(Struct):
        ...     first: int
        ...     second: int = 2
        >>> Pair(1)
        Pair(first=1, second=2)
        """
