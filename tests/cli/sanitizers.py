# SPDX-License-Identifier: MIT
"""Whether a program was built with a sanitizer, which takes memory, address space and time of its own."""


def sanitized(program):
    """In pieces: what this process holds counts as its children's, too. A name across two pieces is met again in the program's symbols."""
    with open(program, "rb") as file:
        return any(b"__asan_init" in piece or b"__tsan_init" in piece for piece in iter(lambda: file.read(1 << 20), b""))
