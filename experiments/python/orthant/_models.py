"""Robots in URDF and models in MJCF as scenes."""

from __future__ import annotations

import os
from typing import Any, NamedTuple, Union

from . import _orthant
from ._scene import override_lines, text_of_file
from ._spec import path


class ImportedModel(NamedTuple):
    """A model as a scene: its TOML text, and notes that name everything which the scene has not."""

    toml: str
    notes: list[str]


def import_model(file: Union[str, os.PathLike[str]], **options: Any) -> ImportedModel:
    """A robot in URDF, or a model in MJCF (MuJoCo's XML), as a scene file's text, commented.

    options: base="free" (of URDF; default "fixed"), floor (height of a half-space, m), mu, fixed_joints="keep", folder
    (from which meshes may be read; default: the model's), and by ** {"at.JOINT": value} (rad or m at the start).

    `simulate` and `Scene.load` take models as they are: orthant.Scene.load("arm.urdf", **{"model.at.elbow": 0.5}).
    """
    name = path("file", file)
    return ImportedModel(*_orthant._import_model(text_of_file(name), name, override_lines(options)))
