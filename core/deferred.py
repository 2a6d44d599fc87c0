"""Names of a package whose modules are loaded when the names are first used."""

import sys
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from types import MappingProxyType, ModuleType
from typing import Any, Generic, TypeVar

Record = TypeVar("Record")


def lazily(
    package: str,
    homes: Mapping[str, tuple[str, ...]],
    modules: Mapping[str, str] = MappingProxyType({}),
) -> Callable[[str], Any]:
    """Return a package's `__getattr__` that imports attributes on first use (PEP 562).

    `homes` has the names that the package exports from each of its modules; `modules` are exported
    as they are, each with its path in the package.
    """
    places = {name: module for module, names in homes.items() for name in names}

    def attribute(name: str) -> Any:
        if name in modules:
            return import_module(f"{package}.{modules[name]}")
        if name not in places:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        value = getattr(import_module(f"{package}.{places[name]}"), name)
        setattr(sys.modules[package], name, value)
        return value

    return attribute


class Exported(Mapping[str, Record], Generic[Record]):
    """The records that packages, by key, export under one name; a package is loaded on request."""

    def __init__(self, name: str, packages: Mapping[str, ModuleType]):
        self._name, self._packages = name, MappingProxyType({**packages})

    def __getitem__(self, key: str) -> Record:
        record: Record = getattr(self._packages[key], self._name)
        return record

    def __contains__(self, key: object) -> bool:
        return key in self._packages  # which loads nothing

    def __iter__(self) -> Iterator[str]:
        return iter(self._packages)

    def __len__(self) -> int:
        return len(self._packages)
