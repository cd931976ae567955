"""Friction of joints in a robot's URDF; what URDF cannot represent is reported.

`<dynamics damping friction>` and `<limit effort>` are on the joint's side of a gear, as in the MJCF. All else of the
file stays as it is. Source: the XML specification of URDF, element `joint` (wiki.ros.org/urdf/XML/joint).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree

from bench.errors import InputError
from bench.export.simulators import SimulatedJoint
from bench.files import read_text
from bench.names import nearest
from bench.plant.mjcf_file import read_mjcf
from bench.plant.model_file import StoredModel

#: Types of joints that move along one axis.
MOVING = ("revolute", "continuous", "prismatic")


def is_urdf(path: Path) -> bool:
    """Whether a robot's file is a URDF, by its root."""
    return "<robot" in read_text(path, "a robot's file")[:100_000] and _root(path).tag == "robot"


def urdf_with(path: Path, models: Mapping[str, StoredModel]) -> tuple[str, tuple[str, ...]]:
    """Text of a URDF with the friction of models at its joints, and what went onto each in sentences.

    Raises:
        InputError: the file is no URDF that MuJoCo reads, or has no such joint.
    """
    read_mjcf(path)  # by the same bounds as any robot
    root, lines = _root(path), []
    joints = {str(joint.get("name")): joint for joint in root.iter("joint") if joint.get("type") in MOVING}
    for name, stored in models.items():
        if name not in joints:
            found = f"found no moving joint of that name{nearest(name, [*joints])}" if name else "missing"
            raise InputError(f"--joint {name}".strip(), found, f"allowed: {', '.join(joints) or 'a URDF with joints'}")
        one = SimulatedJoint(name, stored)
        _child(joints[name], "dynamics").attrib.update(damping=f"{one.damping:.9g}", friction=f"{one.coulomb:.9g}")
        if one.limit is not None and joints[name].find("limit") is not None:
            _child(joints[name], "limit").set("effort", f"{one.limit:.9g}")
        lines.append(f"{name}: damping {one.damping:.4g}, friction {one.coulomb:.4g}")
        unit = stored.model.parameters.kind.inertia_unit
        lines.append(f"{name}: not carried: armature {one.armature:.4g} {unit} (URDF cannot represent it; MJCF can)")
        lines += [f"{name}: not carried: {effect.name} (URDF cannot represent it)" for effect in stored.model.effects]
    ElementTree.indent(root)
    return f'<?xml version="1.0"?>\n{ElementTree.tostring(root, encoding="unicode")}\n', tuple(lines)


def _root(path: Path) -> ElementTree.Element:
    """Of the file, comments included."""
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    try:
        return ElementTree.fromstring(read_text(path, "a robot's file"), parser)
    except ElementTree.ParseError as error:
        raise InputError(path, f"is no XML: {error}", "allowed: MJCF or URDF") from error


def _child(joint: ElementTree.Element, name: str) -> ElementTree.Element:
    found = joint.find(name)
    return ElementTree.SubElement(joint, name) if found is None else found
