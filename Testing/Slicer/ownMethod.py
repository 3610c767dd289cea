"""A method of the user's own, in a file that the worker can import."""

from AIFReconLib import register_method


@register_method
def flat(intensity, probability):
    """Always 77."""
    return 0.1 + probability, 0 * intensity + 77
