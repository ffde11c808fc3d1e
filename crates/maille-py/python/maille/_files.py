"""Files that are whole or not there."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

PREFIX, SUFFIX = ".maille-", ".tmp"


def write_whole(path: Path, data: bytes) -> None:
    """Writes under a temporary name in the same folder and renames."""
    handle, temporary = tempfile.mkstemp(prefix=PREFIX, suffix=SUFFIX, dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as out:
            out.write(data)
            out.flush()
            os.fsync(out.fileno())
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask)
        os.replace(temporary, path)
    except BaseException:
        # Ctrl-C may come once the name is gone.
        Path(temporary).unlink(missing_ok=True)
        raise
