"""The commands, one module each: `add_to` declares the arguments, `run` does the work through the library's public functions."""
