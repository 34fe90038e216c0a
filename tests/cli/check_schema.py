#!/usr/bin/python3
"""check_schema.py KIND < DOCUMENTS: every document of standard input, JSON Lines or YAML,
fits docs/formats/schema/KIND.schema.json, or what evo-data --schema KIND prints."""
import json
import os
import pathlib
import subprocess
import sys

import jsonschema
import yaml

folder = pathlib.Path(os.environ["EVO_SOURCE"]) / "docs/formats/schema"
schemas = {path.name: json.loads(path.read_text()) for path in folder.glob("*.json")}
kind = sys.argv[1]
schema = schemas.get(f"{kind}.schema.json") or json.loads(subprocess.check_output(["evo-data", "--schema", kind]))
jsonschema.Draft202012Validator.check_schema(schema)
resolver = jsonschema.RefResolver("", schema, store=schemas)
validator = jsonschema.Draft202012Validator(schema, resolver=resolver)
text = sys.stdin.read()
try:
    documents = [json.loads(text)]
except ValueError:
    try:
        documents = [json.loads(line) for line in text.splitlines()]
    except ValueError:
        documents = list(yaml.safe_load_all(text))
faults = 0
for number, document in enumerate(documents):
    for error in validator.iter_errors(document):
        print(f"document {number}: /{'/'.join(map(str, error.absolute_path))}: {error.message[:200]}")
        faults += 1
if not documents:
    print("no documents")
sys.exit(1 if faults or not documents else 0)
