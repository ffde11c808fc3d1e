"""Maps, studies, surfaces and fits on a cluster of `dask.distributed`.

    from dask.distributed import Client
    import maille.dask

    client = Client("tcp://scheduler:8786")
    done = maille.dask.characterize(["1.1", "3.1"], "0:180:5", [-0.25, 0.0], client=client, out="results")
    done.to_pandas()

`python -m maille.dask STUDY` does what `maille sweep STUDY` does. The guide is docs/guide/clusters.md of the repository.
"""

from __future__ import annotations

try:
    import distributed as _distributed
    import pyarrow as _pyarrow
except ImportError as error:
    raise ImportError(f"maille.dask needs {error.name}: pip install 'maille[dask]'") from None

from ._fit import fit
from ._maps import characterize
from ._results import Failure, Results
from ._study import sweep
from ._surface import Surfaces, boundary

del _distributed, _pyarrow

__all__ = ["Failure", "Results", "Surfaces", "boundary", "characterize", "fit", "sweep"]
