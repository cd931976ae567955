"""Text of a file that a student saved, in whatever encoding the editor or spreadsheet chose."""

from __future__ import annotations


def text_of(content: bytes) -> str:
    """Bytes as text: UTF-16 with a byte order mark, UTF-8, else Latin-1."""
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")
