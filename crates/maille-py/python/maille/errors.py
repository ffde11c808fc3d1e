"""Exceptions: one class for each kind of error, all of them a `MailleError`, with fields that say where and what would be right."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

__all__ = [
    "ArgumentError",
    "ChainError",
    "DesignError",
    "DesignProblem",
    "EditedRecordError",
    "MailleError",
    "MalformedRecordError",
    "NotARecordError",
    "NotFiniteError",
    "OtherInputsError",
    "RecordError",
    "RecordIOError",
    "RecordInUseError",
    "ShapeError",
    "StudyError",
    "UnknownDesignError",
]


class MailleError(Exception):
    """Base of all errors of maille.

    `problem` is what is wrong, `remedy` what would be right (or None).
    """

    def __init__(self, problem: str, *, remedy: str | None = None) -> None:
        self.problem = problem
        self.remedy = remedy
        super().__init__(problem if remedy is None else f"{problem}; {remedy}")

    def __reduce__(self) -> tuple[Any, ...]:
        # To other processes: the classes are made from fields, not from the text.
        return (_again, (type(self), self.args, self.__dict__))


def _again(of: type[MailleError], args: tuple[Any, ...], fields: dict[str, Any]) -> MailleError:
    error = of.__new__(of)
    error.args = args
    error.__dict__.update(fields)
    return error


class ArgumentError(MailleError, ValueError):
    """An argument with a value that cannot be: its name in `argument`, and in arrays the first place in `index` and the `value` there."""

    def __init__(
        self,
        argument: str,
        problem: str,
        remedy: str | None = None,
        *,
        index: int | None = None,
        value: Any = None,
    ) -> None:
        place = argument if index is None else f"{argument}[{index}] = {value}"
        super().__init__(f"{place}: {problem}" if index is None else f"{place} {problem}", remedy=remedy)
        self.argument = argument
        self.index = index
        self.value = value


class ShapeError(ArgumentError):
    """An array of another shape: `value` is its shape."""


@dataclass(frozen=True)
class DesignProblem:
    """One thing that is wrong with a design; `line` and `column` count from 1 where it is a file."""

    field: str
    problem: str
    remedy: str
    line: int | None
    column: int | None


class DesignError(MailleError, ValueError):
    """A design that cannot be used. `problems` is all that is wrong; `file`, `line`, `column`, `field`, `problem` and `remedy` are those of the first."""

    def __init__(self, *, file: str | None, problems: Sequence[Mapping[str, Any]]) -> None:
        self.problems = tuple(DesignProblem(**problem) for problem in problems)
        first = self.problems[0]
        self.file = file
        self.line = first.line
        self.column = first.column
        self.field = first.field
        super().__init__("\n".join(self._text(problem) for problem in self.problems))
        self.problem = first.problem
        self.remedy = first.remedy

    def _text(self, problem: DesignProblem) -> str:
        place = "" if self.file is None else f"{self.file}: " if problem.line is None else f"{self.file}:{problem.line}: "
        field = f"{problem.field}: " if problem.field else ""
        return f"{place}{field}{problem.problem}; {problem.remedy}"


class UnknownDesignError(MailleError, LookupError):
    """There is no built-in design and no file of that `name`."""

    def __init__(self, name: str, remedy: str) -> None:
        super().__init__(f'there is no built-in design and no file "{name}"', remedy=remedy)
        self.name = name


class StudyError(MailleError, ValueError):
    """A study that cannot be used: the `file`, with `line` and `column` of what is wrong, from 1."""

    def __init__(self, problem: str, remedy: str, file: str, line: int, column: int) -> None:
        super().__init__(f"{file}:{line}: {problem}", remedy=remedy)
        self.problem = problem
        self.file = file
        self.line = line
        self.column = column


class ChainError(MailleError):
    """A chain of limits that a cluster could not compute, though it tried again; `problem` is what the last worker said."""


class RecordError(MailleError):
    """A record that cannot be read, written or continued."""


class RecordIOError(RecordError, OSError):
    """The file system refused to `action` (read, write, create, remove) the file `path`."""

    def __init__(self, problem: str, action: str, path: os.PathLike[str]) -> None:
        super().__init__(problem)
        self.action = action
        self.path = path


class MalformedRecordError(RecordError):
    """A file of the record does not hold what it should: `file` and `line`, from 1."""

    def __init__(self, problem: str, file: str, line: int) -> None:
        super().__init__(problem, remedy="restore the file, or compute the record again with overwrite=True")
        self.file = file
        self.line = line


class EditedRecordError(RecordError):
    """A file of the record is not the one that was written: its SHA-256 is `found`, `expected` stands in run.json."""

    def __init__(self, problem: str, file: str, found: str, expected: str) -> None:
        super().__init__(problem, remedy="restore the file, or compute the record again with overwrite=True")
        self.file = file
        self.found = found
        self.expected = expected


class OtherInputsError(RecordError):
    """The `folder` holds the record of another computation; `difference` names the first fields that differ."""

    def __init__(self, problem: str, folder: os.PathLike[str], difference: str) -> None:
        super().__init__(problem, remedy="name another folder, or replace this record with overwrite=True")
        self.folder = folder
        self.difference = difference


class NotARecordError(RecordError):
    """The `folder` holds files, but no record; `found` names some."""

    def __init__(self, problem: str, folder: os.PathLike[str], found: str) -> None:
        super().__init__(problem, remedy="name the folder of a record, or a new or empty one to write to")
        self.folder = folder
        self.found = found


class RecordInUseError(RecordError):
    """Another run, or an open map of this one, writes to the `folder`."""

    def __init__(self, problem: str, folder: os.PathLike[str]) -> None:
        super().__init__(problem, remedy="wait until it has ended, or name another folder")
        self.folder = folder


class NotFiniteError(RecordError):
    """A number that no record can hold; please report this."""

    def __init__(self, problem: str, direction_deg: float, l2: float, field: str, value: float) -> None:
        super().__init__(problem, remedy="please report this")
        self.direction_deg = direction_deg
        self.l2 = l2
        self.field = field
        self.value = value
