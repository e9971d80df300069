"""Writes the recordings of tests/io.rs with scipy and pyarrow, beside this script."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from scipy.io import savemat

here = Path(__file__).parent
n = 100
i = np.arange(n)
x = (i * i % 97) / 8
for name, compress in [("plain", False), ("compressed", True)]:
    content = {
        "fs": 5120.0,
        "case": x,
        "pair": np.stack([x, -x], axis=1),
        "note": "texts are left out",
        "cell": np.array([1, "a"], dtype=object),
        "short": np.ones(3),
    }
    savemat(here / f"{name}.mat", content, do_compression=compress)

start = 1_704_067_200_000_000_000
table = pa.table(
    {
        "time": pa.array(start + np.round(i / 5120 * 1e9).astype(np.int64), pa.timestamp("ns")),
        "case": x,
        "single": x.astype(np.float32),
        "gaps": pa.array([None if k % 7 == 3 else float(x[k]) for k in i]),
        "tacho": i % 10 == 0,
        "counts": i * 5_000_000 - 2_500_000_000,
        "bytes": (i % 256).astype(np.uint8),
        "note": ["texts are left out"] * n,
        "lists": [[1.0, 2.0]] * n,
    }
).replace_schema_metadata({"fs": "5120"})
for codec in ["none", "snappy", "gzip", "lz4", "zstd"]:
    pq.write_table(table, here / f"{codec}.parquet", compression=codec, row_group_size=40)
