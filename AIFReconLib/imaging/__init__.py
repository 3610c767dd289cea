"""Reading one image: which pixels are ultrasound, where their beams run, what probe they came from, how deep they lie.

May import geometry/ and below; knows nothing of recordings.
"""
