"""What all commands share: options and how they are parsed, progress on the console, the log, an orderly end at a signal."""
