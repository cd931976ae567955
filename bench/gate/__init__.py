"""The gate before any fit: do the signals of a recording mean what its file states?"""
