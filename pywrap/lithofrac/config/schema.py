"""JSON schemas of the config files, generated from the models for editors.

`python -m lithofrac.config.schema configs/schema` writes them; a test fails when they are stale.
The schema of a case asks for no key at the top, because a case may extend another one.
"""

import json
import sys
from pathlib import Path

from lithofrac.config.case import Case
from lithofrac.config.material import Material
from lithofrac.config.study import Study
from lithofrac.config.suite import Suite

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def schemas() -> dict[str, dict]:
    """File name without suffix -> schema."""
    case = Case.model_json_schema()
    properties = case["properties"]
    named = {"type": "string", "description": "Name of a material, or path of its file."}
    changed = {"type": "object", "required": ["extends"], "properties": {"extends": named}}
    for holder in (properties, case["$defs"]["PlatensSection"]["properties"]):
        holder["material"] = {"anyOf": [named, changed, holder["material"]]}
    materials = case["$defs"]["GmshFile"]["properties"]["materials"]
    materials["additionalProperties"] = {
        "anyOf": [named, changed, materials["additionalProperties"]]
    }
    off = {"enum": ["off", False]}  # the word, as YAML 1.2 and 1.1 read it
    properties["fracture"] = {"anyOf": [off, properties["fracture"]]}
    mode = case["$defs"]["FractureSection"]["properties"]["mode"]
    mode["enum"] = [*mode["enum"], False]
    del mode["type"]
    properties["extends"] = {"type": "string", "description": "Case file that this one extends."}
    case.pop("required")
    for section in case["$defs"].values():
        section.pop("required", None)
    found = {"case": case, "material": Material.model_json_schema()}
    found["suite"] = Suite.model_json_schema()
    found["study"] = Study.model_json_schema()
    return {name: {"$schema": DIALECT, **schema} for name, schema in found.items()}


def text_of(schema: dict) -> str:
    """The schema as it stands in its file."""
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def main(folder: Path) -> None:
    """Write all schemas into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, schema in schemas().items():
        (folder / f"{name}.schema.json").write_text(text_of(schema), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
