"""`python -m maille.dask STUDY`: a study of `maille sweep` on a cluster."""

from __future__ import annotations

import argparse
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import distributed

from .. import __version__
from ..errors import MailleError, RecordError, RecordIOError, StudyError
from . import Results, sweep
from ._client import engine

# As the program's.
DONE, FAILED, USAGE, RECORD, INCOMPLETE, LEFT_OUT, INTERRUPTED = 0, 1, 2, 4, 5, 6, 130
#: Statuses of a row without an answer.
UNANSWERED = {"uncertified", "l2-not-reached", "not-converged", "infeasible-start", "interrupted"}

EXAMPLES = """\
Examples:
  maille sweep --example > radius.toml
  python -m maille.dask radius.toml --workers 4
  python -m maille.dask radius.toml --scheduler tcp://10.0.0.1:8786 --out results/radius
  maille table results/radius --where direction=45

Exit codes: 0 every limit was found or proved not to be there, 1 files or the cluster failed, 2 wrong arguments or study,
4 a record is damaged or another one, 5 the records are written but some limits were not found, 6 some designs could not
be used, 130 interrupted: the same command continues from there."""


def main(arguments: list[str] | None = None) -> int:
    """Runs the command; gives the exit code."""
    args = _parser().parse_args(arguments)
    begun = time.monotonic()
    says = _Lines(args.quiet)
    try:
        with _client(args) as client:
            if not client.scheduler_info()["workers"] and not args.quiet:
                print("no worker is there yet; waiting", file=sys.stderr)
            done = sweep(
                args.study,
                out=args.out,
                client=client,
                overwrite=args.overwrite,
                retries=args.retries,
                progress=says,
            )
    except KeyboardInterrupt:
        says.end()
        print("interrupted; the same command continues from here", file=sys.stderr)
        return INTERRUPTED
    except MailleError as error:
        says.end()
        return _failed(error, _code(error))
    except OSError as error:  # no scheduler there, or no room on the disk
        says.end()
        return _failed(error, FAILED)
    says.end()
    return _summary(done, args.quiet, args.allow_incomplete, time.monotonic() - begun)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m maille.dask",
        description="Limits of many designs, radii and spacings on a cluster of dask.distributed: the study file, the records and the "
        "joint table of `maille sweep`, and all rows as a Parquet dataset in chains/.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("study", type=Path, help="the study, a TOML file")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--scheduler", metavar="ADDRESS", help="a running scheduler, as tcp://HOST:8786")
    where.add_argument("--scheduler-file", type=Path, metavar="FILE", help="the file that it has written its address to")
    where.add_argument("--workers", type=_count, metavar="N", help="processes on this machine [default: one a core]")
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="folder that is written [default: maille-out/STUDY]")
    parser.add_argument("--overwrite", action="store_true", help="replace what that folder holds of other inputs")
    parser.add_argument("--allow-incomplete", action="store_true", help="exit code 0 instead of 5 if some limits are not found")
    parser.add_argument("--retries", type=_whole, default=2, metavar="N", help="so often a chain that raised is tried again [default: 2]")
    parser.add_argument("--quiet", "-q", action="store_true", help="no progress and no summary")
    parser.add_argument("--version", action="version", version=f"maille {__version__}, distributed {engine.__version__}")
    return parser


def _whole(text: str) -> int:
    if not text.isdigit():
        raise argparse.ArgumentTypeError(f"{text!r} is no whole number")
    return int(text)


def _count(text: str) -> int:
    count = _whole(text)
    if count == 0:
        raise argparse.ArgumentTypeError("at least one is needed")
    return count


@contextmanager
def _client(args: argparse.Namespace) -> Iterator[distributed.Client]:
    if args.scheduler is not None or args.scheduler_file is not None:
        file = None if args.scheduler_file is None else str(args.scheduler_file)
        if file is not None and not Path(file).is_file():
            raise FileNotFoundError(f"there is no scheduler file {file}")
        with engine.Client(args.scheduler, scheduler_file=file) as client:
            yield client
        return
    # Ctrl-C is for this process, which stops the others.
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        cluster = engine.LocalCluster(
            n_workers=args.workers, threads_per_worker=1, dashboard_address=None, silence_logs=50
        )
    finally:
        signal.signal(signal.SIGINT, before)
    with cluster, engine.Client(cluster) as client:
        yield client


def _code(error: MailleError) -> int:
    if isinstance(error, RecordIOError) and error.action != "read":
        return FAILED
    if isinstance(error, RecordError):
        return RECORD
    return USAGE if isinstance(error, (StudyError, ValueError)) else FAILED


def _failed(error: Exception, code: int) -> int:
    text = " ".join(line.strip() for line in str(error).splitlines())
    print(f"error: {text}", file=sys.stderr)
    return code


def _summary(done: Results, quiet: bool, allow_incomplete: bool, wall_s: float) -> int:
    statuses = [str(status) for record in done.records.values() for status in record.to_numpy()["status"]]
    total = sum(len(record.run["parameters"]["directions_deg"]) * len(record.run["parameters"]["l2"]) for record in done.records.values())
    without = total - len(statuses) + sum(status in UNANSWERED for status in statuses)
    if not quiet:
        for failure in done.failures:
            print(f"could not be computed: {failure}", file=sys.stderr)
        print(
            f"{total} limits in {len(done.records)} records; {done.solved} of {done.chains} chains now, in {wall_s:.1f} s; "
            f"{without} limits were not found"
        )
        if done.records:
            print(f"all rows are in {done.out / 'limits.csv'} and, as Parquet, in {done.out / 'chains'}")
    if done.failures:
        return LEFT_OUT
    return INCOMPLETE if without and not allow_incomplete else DONE


class _Lines:
    """Progress on standard error: one line that changes on a terminal, else a line now and then."""

    INTERVAL_S = 5.0

    def __init__(self, quiet: bool) -> None:
        self._terminal = sys.stderr.isatty()
        self._quiet = quiet
        self._begun = self._said = time.monotonic()
        self._open = False

    def __call__(self, done: int, total: int) -> None:
        now = time.monotonic()
        if self._quiet or total == 0:
            return
        if self._terminal:
            left = f", {(now - self._begun) / done * (total - done):.0f} s left" if done else ""
            print(f"\r\x1b[K{done} of {total} limits{left}", end="", file=sys.stderr, flush=True)
            self._open = True
        elif now - self._said >= self.INTERVAL_S:
            self._said = now
            print(f"{done} of {total} limits", file=sys.stderr, flush=True)

    def end(self) -> None:
        if self._open:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
            self._open = False


if __name__ == "__main__":
    sys.exit(main())
