"""What is fuzzed (`targets`), and the harness for atheris (`python -m tests.fuzz`)."""
