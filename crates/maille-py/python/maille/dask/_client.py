"""Tasks on a cluster: handed out once, their results in the order in which they come."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from typing import Any, TypeVar, Union

import distributed

from ..errors import ArgumentError, ChainError, MailleError

T = TypeVar("T")
#: Most of its functions have no types.
engine: Any = distributed


def client_of(client: distributed.Client | None) -> distributed.Client:
    """The client that is given, or the current one."""
    if client is None:
        try:
            client = engine.get_client()
        except ValueError:
            remedy = "make one: dask.distributed.Client(address), or Client() for the cores of this machine"
            raise ArgumentError("client", "there is none", remedy) from None
    if not isinstance(client, distributed.Client) or client.asynchronous:
        raise ArgumentError("client", f"{client!r} is none that waits", "give a dask.distributed.Client")
    return client


def results(
    client: distributed.Client, function: Callable[..., T], calls: Mapping[str, tuple[Any, ...]], retries: int
) -> Generator[tuple[str, Union[T, MailleError]], None, None]:
    """Calls a function on the workers and gives each result with its key. What raised to the end, or lost its workers more often than the
    scheduler allows, is a `ChainError`. When this is left early, what has not begun is taken back."""
    cluster: Any = client
    futures = {key: cluster.submit(function, *call, key=key, retries=retries) for key, call in calls.items()}
    try:
        for future in engine.as_completed(list(futures.values())):
            del futures[future.key]
            # A result whose worker is lost before it is fetched is computed again, and waited for.
            try:
                value = future.result()
            except Exception as error:
                value = ChainError(f"{type(error).__name__}: {error}".splitlines()[0])
            yield future.key, value
            future.release()
    finally:
        cluster.cancel(list(futures.values()), force=True)
