"""What the module does once when Slicer has started."""

from .sampleData import registerSampleData


def onStartupCompleted() -> None:
    """Offer the sample, and let scenes be loaded that were saved while methods were compared."""
    from AIFReconScene.sliceDisplay import registerLayouts

    registerSampleData()
    registerLayouts()
