"""Suggests what was meant by the name of an argument that does not exist, or by a word that is no choice.

Comes before every other module; `install` is called last, when all of the package is there. Python's own message says
only that an argument is not expected (before 3.13 it does not even guess), which helps little where there are many.
"""

from __future__ import annotations

import difflib
import functools
import inspect
import re
import sys
from collections.abc import Iterable, Sequence
from enum import Enum
from types import FunctionType, ModuleType
from typing import Any, cast

_UNEXPECTED = re.compile(r"(?P<told>.*\(\) got an unexpected keyword argument '(?P<name>\w+)')")


def nearest(word: str, words: Iterable[str]) -> str | None:
    """Return the one of `words` of which `word` may be a misspelling.

    Examples
    --------
    >>> nearest("sampels", ["size", "samples"]), nearest("crop", ["size", "samples"])
    ('samples', None)
    """
    return next(iter(difflib.get_close_matches(word, list(words), n=1)), None)


def hint(name: str, names: Sequence[str]) -> str:
    """Return what to add to a message about an argument that is not among `names`.

    Examples
    --------
    >>> hint("sampels", ["size", "samples"]), hint("wheels", ["size", "samples"])
    ("; did you mean 'samples'?", '; its arguments are size, samples')
    """
    meant = nearest(name, names)
    return f"; did you mean {meant!r}?" if meant else f"; its arguments are {', '.join(names) or 'none'}"


def install(module: ModuleType) -> None:
    """Have all functions, constructors and methods that a module makes public suggest names of arguments."""
    for name in module.__all__:
        value = getattr(module, name)
        if isinstance(value, ModuleType):
            install(value)
        elif isinstance(value, FunctionType) and not hasattr(value, "__wrapped__"):
            wrapper = suggesting(value)
            setattr(module, name, wrapper)
            setattr(sys.modules[value.__module__], value.__name__, wrapper)  # which is where pickles look for it
        elif inspect.isclass(value) and not issubclass(value, (Enum, BaseException)):
            for kind in value.__mro__:
                if kind.__module__.startswith(f"{__package__}."):
                    _install_in_class(kind)


def suggesting(function: FunctionType) -> FunctionType:
    """Return a function that does the same, and names the nearest argument when called with one that it lacks.

    Examples
    --------
    >>> def paint(color, *, gloss=0): ...
    >>> suggesting(paint)(1, glos=2)
    Traceback (most recent call last):
    TypeError: paint() got an unexpected keyword argument 'glos'; did you mean 'gloss'?
    """
    explain = _explain

    def call(*args: Any, **kwargs: Any) -> Any:
        try:
            return function(*args, **kwargs)
        except TypeError as error:
            explain(function, error)
            raise

    # with the globals of the original, by which doctest tells where a function is from
    wrapper = FunctionType(call.__code__, function.__globals__, function.__name__, None, call.__closure__)
    functools.update_wrapper(wrapper, function)
    return wrapper


def _explain(function: FunctionType, error: TypeError) -> None:
    """Add to the message of a call that did not come about."""
    if error.__traceback__ is None or error.__traceback__.tb_next is not None:
        return  # raised within the function
    found = _UNEXPECTED.match(str(error))
    if found:
        parameters = inspect.signature(function).parameters.values()
        names = [p.name for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY) and p.name != "self"]
        error.args = (found["told"].replace(".__init__()", "()") + hint(found["name"], names),)


def _install_in_class(kind: type[Any]) -> None:
    for name, member in list(vars(kind).items()):
        if name != "__init__" and name.startswith("_"):
            continue
        if isinstance(member, FunctionType) and not hasattr(member, "__wrapped__"):
            setattr(kind, name, suggesting(member))
        elif isinstance(member, (classmethod, staticmethod)) and not hasattr(member.__func__, "__wrapped__"):
            setattr(kind, name, type(member)(suggesting(cast(FunctionType, member.__func__))))
