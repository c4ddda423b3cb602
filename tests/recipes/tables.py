"""Reads a sweep's tables with pandas and pyarrow: CSV, JSON lines and Parquet hold the same. `tables.py CSV JSONL [PARQUET]`."""

import sys

import pandas

csv = pandas.read_csv(sys.argv[1])
lines = pandas.read_json(sys.argv[2], lines=True, precise_float=True, dtype=False)
others = {"JSON lines": lines}
if len(sys.argv) > 3:
    others["Parquet"] = pandas.read_parquet(sys.argv[3])
assert len(csv) == 200 and csv["run"].tolist() == list(range(200)), "runs"
assert csv["error"].isna().all(), "errors"
assert csv["p14.peak (N)"].gt(0).all(), "a pulse at particle 14"
for name, other in others.items():
    assert list(other.columns) == list(csv.columns), f"{name}: columns"
    for column in csv.columns:
        if csv[column].isna().all():
            assert other[column].isna().all(), f"{name}: {column}"
        # JSON numbers come back to 1 unit in the last place from pandas' reader.
        elif name == "Parquet":
            assert (other[column] == csv[column]).all(), f"{name}: {column}"
        else:
            assert ((other[column] - csv[column]).abs() <= 4e-16 * csv[column].abs()).all(), f"{name}: {column}"
print(f"pandas {pandas.__version__} reads {' and '.join(['CSV', *others])} alike")
