"""Results as nodes: volumes, comparison of methods, metrics; and the sample patient.

May import inputs/ and sweep/.
"""
