"""Files of a run: tables, fields, checkpoints. Nothing half-written ever looks whole."""
