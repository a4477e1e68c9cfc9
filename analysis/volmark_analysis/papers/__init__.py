"""Papers whose tables and figures are reproduced: published numbers beside measured ones."""
