"""The Qt side of the AIFRecon module: what its widget is made of besides the .ui file."""
