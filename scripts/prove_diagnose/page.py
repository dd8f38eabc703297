# SPDX-License-Identifier: MIT
"""Where tables go: on standard output, or between their marks in a page."""

import page_tables


def show(path, tables):
    """tables: {name of the mark: markdown}. path: the page, or None to print."""
    if path:
        page_tables.write(path, "prove-diagnose", tables)
    else:
        print("\n\n".join(text.rstrip("\n") for text in tables.values()))
