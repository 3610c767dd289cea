"""The live side: messages from an OpenIGTLink stream become tracked frames and voxels while the scan goes on; pyigtl lives here only."""
