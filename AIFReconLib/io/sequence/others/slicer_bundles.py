"""Scene bundles of Slicer (.mrb): the recording in one, with all transforms above its images multiplied into ImageToReference.

A bundle is a zip archive of a scene in XML and the files that it names. A browser of sequences names the sequences that belong together,
and for each the node that it is replayed into; above that node are transforms, some of them replayed too. Reference is the world of the
scene.
"""

from __future__ import annotations

import os
import tempfile
import weakref
import zipfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from urllib.parse import unquote
from xml.etree.ElementTree import Element

import numpy as np

from ....arrays import Matrix
from ....errors import AIFReconError, SequenceFormatError, TransformError
from ....geometry.transform_graph import TransformName, TransformSample, TransformStatus
from ....message import said
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
MOST_PARENTS = 100
NO_STATUS = "Slicer's bundles say of every pose that it is valid: frames in which the tracker was lost may have the last one before."
_PICTURES, _MOVES = "VolumeSequenceStorage", "LinearTransformSequenceStorage"


def _read(path: Path, orientation: str | None) -> Recorded:
    require_regular_file(path, SequenceFormatError)
    readable = decoding(f"{path}: it cannot be read as a scene of Slicer", "Save it from Slicer again.")
    with readable, zipfile.ZipFile(path) as archive, ExitStack() as stack:
        folder = stack.enter_context(workspace(Path(tempfile.gettempdir())))
        try:
            recorded = _recorded(_Scene.of(path, archive, folder), orientation)
        except AIFReconError as error:
            text = str(said(error))
            if str(folder) not in text:
                raise
            raise SequenceFormatError(f"{path}: {text.replace(f'{folder}{os.sep}', '')}", error) from error
        weakref.finalize(recorded.images, stack.pop_all().close)
    return recorded


@dataclass(frozen=True)
class _Scene:
    path: Path
    archive: zipfile.ZipFile
    folder: Path
    nodes: Mapping[str, Element]
    base: str

    @classmethod
    def of(cls, path: Path, archive: zipfile.ZipFile, folder: Path) -> _Scene:
        names = [name for name in archive.namelist() if name.lower().endswith(".mrml")]
        if len(names) != 1:
            raise SequenceFormatError(f"{path}: it must hold one scene (.mrml); got {len(names)}. Save it from Slicer again.")
        root = parse_xml(Path(archive.extract(names[0], folder)))
        nodes = {node.get("id", ""): node for node in root.iter() if node.get("id")}
        return cls(path, archive, folder, nodes, str(PurePosixPath(names[0]).parent))

    def references(self, node: Element) -> dict[str, str]:
        """Ids of the first node in each role."""
        pairs = (part.partition(":") for part in node.get("references", "").split(";"))
        return {role: ids.split()[0] for role, _, ids in pairs if ids.split()}

    def parent(self, node: Element) -> Element | None:
        """The transform that a node is under."""
        return self.nodes.get(self.references(node).get("transform", node.get("transformNodeRef", "")))

    def storage(self, node: Element) -> Element | None:
        return self.nodes.get(self.references(node).get("storage", node.get("storageNodeRef", "")))

    def stored(self, node: Element) -> Path:
        """The file of a node."""
        storage = self.storage(node)
        name = "" if storage is None else storage.get("fileName", "")
        for spelled in (name, unquote(name)):
            member = str(PurePosixPath(self.base, spelled))
            if spelled and member in self.archive.NameToInfo:
                return Path(self.archive.extract(member, self.folder))
        raise SequenceFormatError(
            f"{self.path}: the file of {node.get('name')} ({name or 'none'}) is not in it. Save it from Slicer again."
        )


def _recorded(scene: _Scene, orientation: str | None) -> Recorded:
    browsers = [node for node in scene.nodes.values() if node.tag == "SequenceBrowser"]
    found = [
        (browser, sequence) for browser in browsers for sequence, _ in _replayed(scene, browser) if _kind(scene, sequence) == _PICTURES
    ]
    if len(found) != 1:
        names = ", ".join(str(sequence.get("name")) for _, sequence in found)
        raise SequenceFormatError(
            f"{scene.path}: it must hold one recording of images; got {len(found)}{names and f' ({names})'}. Save a scene with one of them."
        )
    browser, pictures = found[0]
    replayed = _replayed(scene, browser)
    recorded = METAFILES.read(scene.stored(pictures), orientation)
    sequence_of = {proxy.get("id"): sequence for sequence, proxy in replayed if proxy is not None}
    proxy = next(node for sequence, node in replayed if sequence is pictures)
    chain = [] if proxy is None else _above(scene, proxy)
    if any(link.get("id") in sequence_of for link in chain):
        records: Sequence[FrameRecord] = _placed(scene, recorded.records, [(link, sequence_of.get(link.get("id"))) for link in chain])
    else:
        records = _beside(scene, recorded.records, [sequence for sequence, _ in replayed if _kind(scene, sequence) == _MOVES])
    return replace(recorded, records=records, notes=(*recorded.notes, NO_STATUS))


def _replayed(scene: _Scene, browser: Element) -> list[tuple[Element, Element | None]]:
    """Sequences of a browser, each with the node that it is replayed into."""
    roles = scene.references(browser)
    pairs = []
    for role, identifier in roles.items():
        for prefix in ("sequenceNodeRef", "rootNodeRef"):
            sequence = scene.nodes.get(identifier)
            if role.startswith(prefix) and sequence is not None:
                pairs.append((sequence, scene.nodes.get(roles.get(f"dataNodeRef{role.removeprefix(prefix)}", ""))))
    return pairs


def _kind(scene: _Scene, sequence: Element) -> str | None:
    storage = scene.storage(sequence)
    return None if storage is None else storage.tag


def _above(scene: _Scene, node: Element) -> list[Element]:
    """The transforms above a node, nearest first."""
    chain: list[Element] = []
    parent = scene.parent(node)
    while parent is not None:
        chain.append(parent)
        if len(chain) > MOST_PARENTS:
            raise SequenceFormatError(f"{scene.path}: the transforms above the images lead in a circle. Save it from Slicer again.")
        parent = scene.parent(parent)
    return chain


def _placed(scene: _Scene, records: Sequence[FrameRecord], chain: list[tuple[Element, Element | None]]) -> list[FrameRecord]:
    """Records whose only transform is the product of all above the image."""
    product = [TransformSample(np.eye(4))] * len(records)
    for link, sequence in chain:
        if sequence is None:
            still = TransformSample(_still(scene, link))
            samples = [still] * len(records)
        else:
            name = TransformName("Below", "Above")
            paired, _ = pair_transforms(records, {str(name): scene.stored(sequence)})
            samples = [record.transforms[name] for record in paired]
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
        try:
            name = TransformName.parse(str(sequence.get("name")).removesuffix("Transform"))
        except TransformError:
            continue
        records, _ = pair_transforms(records, {str(name): scene.stored(sequence)})
    return records


BUNDLES = RecordingKind("a scene bundle of Slicer", (".mrb",), _read)
