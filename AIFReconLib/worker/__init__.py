"""A process that works for another, which stays free for its windows: Slicer's module starts one.

Functions of the library are called in it as anywhere: arguments, results, progress, cancel and errors cross as values.
May import everything but commands/ and batch/.
"""
