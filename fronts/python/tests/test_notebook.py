"""The examples of the notebook run from top to bottom."""

import json
import pathlib

NOTEBOOK = pathlib.Path(__file__).parent.parent / "examples" / "five.ipynb"


def test_all_cells_run(monkeypatch, capsys):
    # By letters: pictures need what tests do not.
    monkeypatch.setitem(__import__("sys").modules, "matplotlib", None)
    cells, names = json.loads(NOTEBOOK.read_text())["cells"], {}
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    for number, source in enumerate(code):
        exec(compile(source, f"cell {number}", "exec"), names)
    said = capsys.readouterr().out
    assert len(code) == 6 and not any(cell.get("outputs") for cell in cells)
    for part in ("2060 objects", "objects that can be seen", "what its tile sees", "let through", "9 cells"):
        assert part in said, said
    assert len(set(said)) > 20
