"""A lumbar spine that is known exactly, its CT, and tracked ultrasound sweeps of it: what demos, tests and the study measure against.

May import sweep/, imaging/, geometry/ and below.
"""
