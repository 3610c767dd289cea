"""Scene bundles of Slicer (.mrb): the recording in one, with all transforms above its images multiplied into ImageToReference.

A bundle is a zip archive of a scene in XML and the files that it names. A browser of sequences names the sequences that belong together,
and for each the node that it is replayed into; above that node are transforms, some of them replayed too. Reference is the world of the
scene.
"""

from __future__ import annotations

import os
import re
import tempfile
import weakref
import zipfile
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from dataclasses import replace
from pathlib import Path, PurePosixPath
from urllib.parse import unquote
from xml.etree.ElementTree import Element

import numpy as np

from ....arrays import Matrix
from ....errors import AIFReconError, SequenceFormatError, TransformError
from ....geometry.transform_graph import TransformName, TransformSample, TransformStatus
from ....message import message_of
from ....sweep.frames import FrameRecord
from ...disk.regular_files import require_regular_file
from ...disk.workspace import workspace
from ...disk.xml_tree import parse_xml
from ...metafile.text_values import NotANumberError, parse_matrix
from ..decoded_images import decoding
from ..kinds import Recorded, RecordingKind
from ..metafiles import METAFILES
from ..transforms import pair_transforms

IMAGE = TransformName("Image", "Reference")
NO_STATUS = "Slicer's bundles say of every pose that it is valid: frames in which the tracker was lost may have the last one before."
_PICTURES, _MOVES = "VolumeSequenceStorage", "LinearTransformSequenceStorage"


def _read(path: Path, orientation: str | None) -> Recorded:
    require_regular_file(path, SequenceFormatError)
    readable = decoding(f"{path}: it cannot be read as a scene of Slicer", "Save it from Slicer again.")
    with readable, zipfile.ZipFile(path) as archive, ExitStack() as stack:
        folder = stack.enter_context(workspace(Path(tempfile.gettempdir())))
        try:
            recorded = _recorded(_Scene(path, archive, folder), orientation)
        except AIFReconError as error:
            text = str(message_of(error))
            if str(folder) not in text:
                raise
            raise SequenceFormatError(f"{path}: {text.replace(f'{folder}{os.sep}', '')}", error) from error
        weakref.finalize(recorded.images, stack.pop_all().close)
    return recorded


class _Scene:
    """The nodes of a scene, by their ids, and the files that they name."""

    def __init__(self, path: Path, archive: zipfile.ZipFile, folder: Path):
        self.path, self._archive, self._folder = path, archive, folder
        names = [name for name in archive.namelist() if name.lower().endswith(".mrml")]
        if len(names) != 1:
            raise SequenceFormatError(f"{path}: it must hold one scene (.mrml); got {len(names)}. Save it from Slicer again.")
        self._base = PurePosixPath(names[0]).parent
        root = parse_xml(Path(archive.extract(names[0], folder)))
        self.nodes = {name: node for node in root.iter() if (name := node.get("id"))}

    def references(self, node: Element) -> dict[str, str]:
        """Ids of the first node in each role."""
        pairs = (part.partition(":") for part in node.get("references", "").split(";"))
        return {role: ids.split()[0] for role, _, ids in pairs if ids.split()}

    def parent(self, node: Element) -> Element | None:
        """The transform that a node is under."""
        return self.nodes.get(self.references(node).get("transform", node.get("transformNodeRef", "")))

    def storage(self, node: Element) -> Element:
        """What says where the file of a node is; an element without a word where nothing does."""
        return self.nodes.get(self.references(node).get("storage", node.get("storageNodeRef", "")), Element(""))

    def stored(self, node: Element) -> Path:
        """The file of a node."""
        name = self.storage(node).get("fileName", "")
        for member in (str(self._base / spelled) for spelled in (name, unquote(name))):
            if member in self._archive.NameToInfo:
                return Path(self._archive.extract(member, self._folder))
        missing = f"the file of {node.get('name')} ({name or 'none'}) is not in it"
        raise SequenceFormatError(f"{self.path}: {missing}. Save it from Slicer again.")

    def replayed(self, browser: Element) -> list[tuple[Element, Element | None]]:
        """Sequences of a browser, each with the node that it is replayed into."""
        roles = self.references(browser)
        numbered = ((re.fullmatch("(sequenceNodeRef|rootNodeRef)(.*)", role), self.nodes.get(found)) for role, found in roles.items())
        return [(node, self.nodes.get(roles.get(f"dataNodeRef{of[2]}", ""))) for of, node in numbered if of and node is not None]


def _recorded(scene: _Scene, orientation: str | None) -> Recorded:
    browsers = [scene.replayed(node) for node in scene.nodes.values() if node.tag == "SequenceBrowser"]
    found = [(each, *pair) for each in browsers for pair in each if scene.storage(pair[0]).tag == _PICTURES]
    if len(found) != 1:
        names = ", ".join(str(sequence.get("name")) for _, sequence, _ in found) or "none"
        raise SequenceFormatError(f"{scene.path}: it must hold one recording of images; got {len(found)} ({names}). Save one of them.")
    replayed, pictures, proxy = found[0]
    recorded = METAFILES.read(scene.stored(pictures), orientation)
    sequence_of = {into.get("id"): sequence for sequence, into in replayed if into is not None}
    chain = _above(scene, proxy)
    if any(link.get("id") in sequence_of for link in chain):
        records: Sequence[FrameRecord] = _placed(scene, recorded.records, [(link, sequence_of.get(link.get("id"))) for link in chain])
    else:
        moves = [sequence for sequence, _ in replayed if scene.storage(sequence).tag == _MOVES]
        records = _beside(scene, recorded.records, moves)
    return replace(recorded, records=records, notes=(*recorded.notes, NO_STATUS))


def _above(scene: _Scene, node: Element | None) -> list[Element]:
    """The transforms above a node, nearest first."""
    chain: list[Element] = []
    while node is not None and (node := scene.parent(node)) is not None:
        if node in chain:
            raise SequenceFormatError(f"{scene.path}: the transforms above the images lead in a circle. Save it from Slicer again.")
        chain.append(node)
    return chain


def _placed(scene: _Scene, records: Sequence[FrameRecord], chain: list[tuple[Element, Element | None]]) -> list[FrameRecord]:
    """Records whose only transform is the product of all above the image."""
    product, name = [TransformSample(np.eye(4))] * len(records), TransformName("Below", "Above")
    for link, sequence in chain:
        if sequence is None:
            samples = [TransformSample(_still(scene, link))] * len(records)
        else:
            samples = [record.transforms[name] for record in pair_transforms(records, {str(name): scene.stored(sequence)})[0]]
        product = [_times(above, below) for above, below in zip(samples, product)]
    return [replace(record, transforms={IMAGE: sample}) for record, sample in zip(records, product)]


def _times(above: TransformSample, below: TransformSample) -> TransformSample:
    status = below.status if above.status is TransformStatus.OK else above.status
    with np.errstate(invalid="ignore", over="ignore"):
        return TransformSample(above.matrix @ below.matrix, status)


def _still(scene: _Scene, link: Element) -> Matrix:
    """The matrix of a transform that was not recorded, to its parent."""
    text = link.get("matrixTransformToParent")
    if link.tag != "LinearTransform" or text is None:
        from ...transform.files import read_transform  # SimpleITK, which Slicer's own process must not load

        return read_transform(scene.stored(link))
    try:
        return parse_matrix(text)
    except NotANumberError as error:
        raise SequenceFormatError(f"{scene.path}: {link.get('name')} must be 16 numbers; {error}. Save it from Slicer again.") from error


def _beside(scene: _Scene, records: Sequence[FrameRecord], moves: list[Element]) -> Sequence[FrameRecord]:
    """Records with the transforms that were recorded beside the images, which are under none of them; those that are named FromToTo."""
    for sequence in moves:
        with suppress(TransformError):
            name = TransformName.parse(str(sequence.get("name")).removesuffix("Transform"))
            records, _ = pair_transforms(records, {str(name): scene.stored(sequence)})
    return records


BUNDLES = RecordingKind("a scene bundle of Slicer", (".mrb",), _read)
