"""Packages that only some functions need."""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def extra(name: str) -> Iterator[None]:
    """Around an import: where the package is missing, the error says what to install."""
    try:
        yield
    except ModuleNotFoundError as e:
        raise ModuleNotFoundError(f'this needs {e.name}: pip install "maille[{name}]"', name=e.name) from None
