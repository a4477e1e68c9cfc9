"""Tables, plots, pictures and reports from volmark's results folders (harness/README.md, section 7)."""

__version__ = "0.1.0"
