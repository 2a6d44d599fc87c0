"""Names of a package whose modules are loaded when the names are first used."""

import sys
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any, Generic, TypeVar

Record = TypeVar("Record")


def lazily(
    package: str,
    exports: Mapping[str, tuple[str, ...]],
    modules: Mapping[str, str] = MappingProxyType({}),
) -> Callable[[str], Any]:
    """Return a package's `__getattr__` that imports attributes on first use (PEP 562).

    `exports` has the names that the package exports from each of its modules; `modules` are
    exported as they are, each with its path in the package.
    """
    module_of = {name: module for module, names in exports.items() for name in names}

    def attribute(name: str) -> Any:
        if name in modules:
            return import_module(f"{package}.{modules[name]}")
        if name not in module_of:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        value = getattr(import_module(f"{package}.{module_of[name]}"), name)
        setattr(sys.modules[package], name, value)
        return value

    return attribute


class Exported(Mapping[str, Record], Generic[Record]):
    """The records that modules, by key, hold under one name; a module is loaded on request."""

    def __init__(self, name: str, modules: Mapping[str, str]):
        self._name, self._modules = name, MappingProxyType({**modules})

    def __getitem__(self, key: str) -> Record:
        record: Record = getattr(import_module(self._modules[key]), self._name)
        return record

    def __contains__(self, key: object) -> bool:
        return key in self._modules  # which loads nothing

    def __iter__(self) -> Iterator[str]:
        return iter(self._modules)

    def __len__(self) -> int:
        return len(self._modules)
