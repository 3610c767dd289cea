"""Looking at results: metrics against true bone, figures and reports. The only place that imports matplotlib.

May import resolve and everything below it, and io/.
"""
