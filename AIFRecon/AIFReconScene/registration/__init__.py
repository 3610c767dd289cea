"""The CT and its segmentation find their place on the sweep: what is asked of the library, and which transform is moved.

May import inputs/ and sweep/.
"""
