"""AIFRecon."""
