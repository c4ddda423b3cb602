"""Executes the cells of docs/recipes/recording.ipynb, in order, in the folder of a recording of `magnet-0.61g`, and looks at what they leave."""

import json
import sys
from pathlib import Path

notebook = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
names = {}
for cell in notebook["cells"]:
    if cell["cell_type"] == "code":
        source = cell["source"]
        exec(source if isinstance(source, str) else "".join(source), names)

volts, forces = names["volts"], names["forces"]
assert list(volts.columns) == ["CH1 (V)", "CH2 (V)", "CH3 (V)", "CH4 (V)"], list(volts.columns)
assert len(volts) == 2500, len(volts)
assert abs(volts.index[1] - volts.index[0] - 1e-6) < 1e-12, "250 us/div are 1 us a sample"
# Total first peaks from outside: tests/golden/bench-goldens.json.
for column, peak in zip(forces.columns, [6.701987908, 5.610915878, 5.051851269]):
    assert abs(forces[column].max() / peak - 1) < 1e-3, (column, forces[column].max())
print(f"recording.ipynb: {len(volts)} samples of {volts.shape[1]} channels, {forces.shape[1]} forces")
