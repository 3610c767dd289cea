"""The part of Slicer's SampleData module that a module needs to offer its own data."""

from __future__ import annotations

from types import SimpleNamespace

import slicer


class SampleDataLogic:
    """Keeps the data sets on offer in `slicer.modules.sampleDataSources`, by category."""

    @staticmethod
    def registerCustomSampleDataSource(category="Custom", **described):
        source = SimpleNamespace(**described)
        if not hasattr(slicer.modules, "sampleDataSources"):
            slicer.modules.sampleDataSources = {}
        sources = slicer.modules.sampleDataSources.setdefault(category, [])
        if source not in sources:
            sources.append(source)
