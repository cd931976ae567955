"""Effects: everything about one piece of physics in one file, found by discovery."""
