"""The part of Slicer's SampleData module that a module needs to offer its own data."""

from __future__ import annotations

from dataclasses import dataclass

import slicer


@dataclass
class SampleDataSource:
    """A data set on offer."""

    sampleName: str | None = None
    sampleDescription: str | None = None
    uris: object = None
    fileNames: object = None
    nodeNames: object = None
    checksums: object = None
    loadFiles: object = None
    customDownloader: object = None
    thumbnailFileName: str | None = None
    loadFileTypes: object = None
    loadFileProperties: object = None


class SampleDataLogic:
    """Keeps the data sets on offer in `slicer.modules.sampleDataSources`, by category."""

    @staticmethod
    def registerCustomSampleDataSource(category="Custom", **described):
        source = SampleDataSource(**described)
        if not hasattr(slicer.modules, "sampleDataSources"):
            slicer.modules.sampleDataSources = {}
        sources = slicer.modules.sampleDataSources.setdefault(category, [])
        if source not in sources:
            sources.append(source)
