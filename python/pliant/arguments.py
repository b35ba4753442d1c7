# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What callers give, checked: a TypeError or a ValueError says which argument is of the wrong kind."""

from __future__ import annotations

import operator
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat, SupportsIndex, Union

import numpy as np

from . import _pliant

if TYPE_CHECKING:
    from numpy.typing import NDArray

# As callers may give them, also NumPy's.
Wholes = Union["Sequence[SupportsIndex]", "NDArray[Any]"]
Numbers = Union["Sequence[SupportsFloat]", "NDArray[Any]"]


def wrong(value: Any, name: str, wanted: str) -> TypeError:
    return TypeError(f"{name} is a {type(value).__name__}; give {wanted}")


def error(code: str, sentence: str) -> _pliant.Error:
    """As the library raises it."""
    result = _pliant.Error(sentence)
    result.code = code
    return result


def whole(value: Any, name: str, low: int = -2**31, high: int = 2**31 - 1) -> int:
    """A whole number from low to high (those of an int of the library), also NumPy's, and a float that is one."""
    try:
        is_whole_float = isinstance(value, (float, np.floating)) and float(value).is_integer()
        chosen = int(value) if is_whole_float else operator.index(value)
    except TypeError:
        raise wrong(value, name, "a whole number") from None
    if not low <= chosen <= high:
        raise ValueError(f"{name} is {chosen}; give a whole number from {low} to {high}")
    return chosen


def number(value: Any, name: str) -> float:
    if isinstance(value, (str, bytes)):
        raise wrong(value, name, "a number")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise wrong(value, name, "a number") from None


def numbers(values: Any, name: str) -> list[float]:
    """Of a list, or of an array of one axis."""
    if np.ndim(values) != 1 or isinstance(values, (str, bytes)):
        raise wrong(values, name, "a list of numbers, or an array of one axis")
    return [number(value, name) for value in values]


def wholes(values: Iterable[Any] | None, name: str) -> list[int]:
    """Numbers of frames; none of None, which is no choice."""
    if values is None:
        return []
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        raise wrong(values, name, "a list of whole numbers")
    chosen = [whole(value, name) for value in values]
    if not chosen:
        raise ValueError(f"{name} has no frame; give numbers of frames, or None")
    return chosen


def several(values: Any, name: str, wanted: str) -> list[Any]:
    if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Iterable):
        raise wrong(values, name, wanted)
    return list(values)


def images(value: Any) -> Any:
    """What images can be taken from."""
    can_index = hasattr(value, "__len__") and hasattr(value, "__getitem__")
    is_number = isinstance(value, np.ndarray) and value.ndim == 0
    if is_number or isinstance(value, (bytes, bytearray)) or not (can_index or isinstance(value, Iterable)):
        raise wrong(value, "input", "a path, a pliant.Sequence, or a list, an array or another iterable of images")
    return value


def truth(value: Any, name: str) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise wrong(value, name, "True or False")
    return bool(value)


def _utf8(value: str, name: str, advice: str) -> str:
    """As the library and its files have it: what Python makes of other names of files cannot be written there."""
    if "\0" in value:
        raise ValueError(f"{name}, {value!r}, has a character of the code 0; leave it out")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise ValueError(f"{name}, {value!r}, is not UTF-8; {advice}") from None
    return value


def text(value: Any, name: str) -> str:
    if not isinstance(value, str):
        raise wrong(value, name, "text")
    return _utf8(value, name, "give other text")


def optional_text(value: Any, name: str) -> str:
    """"" for None."""
    return "" if value is None else text(value, name)


def path(value: Any, name: str) -> str:
    if not isinstance(value, (str, os.PathLike)):
        raise wrong(value, name, "a path")
    chosen = os.fspath(value)
    if not isinstance(chosen, str):
        raise wrong(chosen, name, "a path of text")
    return _utf8(chosen, name, "rename it")


def optional_path(value: Any, name: str) -> str:
    """"" for None."""
    return "" if value is None else path(value, name)


def function(value: Any, name: str) -> Callable[..., Any] | None:
    """Or None."""
    if value is not None and not callable(value):
        raise wrong(value, name, "a function, or None")
    return value


def camera(value: Any, name: str = "camera") -> _pliant.Camera:
    if not isinstance(value, _pliant.Camera):
        raise wrong(value, name, "a pliant.Camera (pliant.read_camera reads a file)")
    return value


def camera_path(value: Any) -> str:
    """The path of a calibration file; "" for None."""
    if isinstance(value, _pliant.Camera):
        raise ValueError("camera is a pliant.Camera, and the images are a path; give the path of its calibration, which "
                         "camera.write makes")
    return optional_path(value, "camera")


def options(values: Any) -> Any:
    """A dictionary of any mapping; what is none is refused where it is read."""
    if not isinstance(values, Mapping):
        return values
    for name, value in values.items():
        for part in (name, *(value if isinstance(value, (list, tuple)) else [value])):
            part = os.fspath(part) if isinstance(part, os.PathLike) else part
            if isinstance(part, str):
                _utf8(part, "an option" if part is name else f"the option {name}", "give another name")
    return dict(values)


def options_with(values: Any, named: dict[str, str]) -> Any:
    """Options with those that arguments name; "" names none. What is no dictionary is refused where it is read."""
    named = {name: value for name, value in named.items() if value}
    values = options(values)
    if not named or not (values is None or isinstance(values, dict)):
        return values
    return {**(values or {}), **named}


def refuse_both(values: Any, option: str, name: str, value: Any) -> None:
    """That an argument and an option name two things; a former option of the same text is the same."""
    other = values.get(option) if isinstance(values, Mapping) else None
    if value is not None and other and str(other) != str(value):
        raise ValueError(f"there is the argument {name}, and the option {option} is {str(other)!r}; give one of them")


def files(**paths: Any) -> dict[str, str]:
    """Paths that may be None, of a request: NAME_path by NAME."""
    return {f"{name}_path": camera_path(value) if name == "camera" else optional_path(value, name)
            for name, value in paths.items()}
