"""What is chosen in the panel and what the library gets of it: bone, box, imaging, settings, and what is missing.

May import sweep/.
"""
