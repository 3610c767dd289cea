"""A scan while it goes on: messages from an OpenIGTLink stream become tracked frames and voxels; pyigtl lives here only.

wire/ speaks the protocol, pairing/ makes frames of messages, session/ makes voxels of frames, replay/ is a server. Each may import those
named before it, and reconstruction and below.
"""
