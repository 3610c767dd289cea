"""A recorded sweep as nodes, and nodes as a sweep: sequence browsers, their images, poses and what is known of them.

May import the files beside the rooms only.
"""
