"""Methods of one's own: a function over the arrays of a frame, and the engine that adds up what it answers.

May import the rest of compounding/ and what that may import.
"""
