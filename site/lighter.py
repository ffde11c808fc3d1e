"""A table without the inputs of each record, which are most of its bytes: python site/lighter.py FROM TO

Names, meanings and units of the columns are kept.
"""

import sys

import pyarrow.parquet as parquet

table = parquet.read_table(sys.argv[1])
parquet.write_table(table.replace_schema_metadata(None), sys.argv[2], compression="zstd")
