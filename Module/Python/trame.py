# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Deformed volumes in views that are drawn by the page: VtkLocalView of trame-vtk, and PyVista's
export_html() and backend "client".

    import vtkffd.trame

is all that is needed, before or after the view is made; vtkffd.pyvista does it where trame-vtk is
installed. Pages do not know vtkFFDInverseRayVolumeMapper and would leave its volumes out. They get a
copy of the volume that is resampled (vtkFFDResampleVolume) whenever the view is sent and something has
changed, and draw that by their own mapper. Volumes must be vtkImageData, shown by scalars of points;
others are left out with a warning.

Needs trame-vtk: ImportError without it.
"""

import warnings as _warnings
import weakref as _weakref

from trame_vtk.modules.vtk.serializers import serialize as _serialize
from trame_vtk.modules.vtk.serializers.registry import register_instance_serializer as _register
from vtkmodules import vtkRenderingCore as _core
from vtkmodules.vtkCommonDataModel import vtkImageData as _vtkImageData
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper as _Mapper

import vtkffd as _vtkffd

__all__ = []


def _find_scalars(mapper, image):
    """The point scalars that the mapper shows, or None if it shows others."""
    data = image.GetPointData()
    if mapper.GetScalarMode() == _core.VTK_SCALAR_MODE_USE_POINT_FIELD_DATA:
        by_name = mapper.GetArrayAccessMode() == _core.VTK_GET_ARRAY_BY_NAME
        return data.GetArray(mapper.GetArrayName() if by_name else mapper.GetArrayId())
    of_points = (_core.VTK_SCALAR_MODE_DEFAULT, _core.VTK_SCALAR_MODE_USE_POINT_DATA)
    return data.GetScalars() if mapper.GetScalarMode() in of_points else None


class _Copy:
    """What a page draws in the place of a mapper."""

    def __init__(self):
        self.resample = _vtkffd.vtkFFDResampleVolume()
        self.mapper = _Mapper()  # of a kind that pages know; it draws nothing here

    def update(self, volume, original):
        """Bring it up to date; false if it cannot be made."""
        source = original.GetInputConnection(0, 0)
        source.GetProducer().Update()
        image = original.GetInputDataObject(0, 0)
        scalars = isinstance(image, _vtkImageData) and _find_scalars(original, image)
        if not scalars:
            return False
        active = scalars is image.GetPointData().GetScalars()
        if not active and not scalars.GetName():
            return False
        if original.GetDeformation() or _vtkffd.vtkFFDLattice.HasLattice(image) or not active:
            # The end of the range that is seen less surrounds the volume.
            opacity = volume.GetProperty().GetScalarOpacity()
            resample = self.resample
            resample.SetInputConnection(source)
            resample.SetInputArrayToProcess(0, 0, 0, 0, "" if active else scalars.GetName())
            resample.SetDeformation(original.GetDeformation())
            resample.SetInverseMode(original.GetInverseMode())
            resample.SetPositionTolerance(original.GetPositionTolerance())
            resample.SetBackgroundLevel(min(scalars.GetFiniteRange(0), key=opacity.GetValue))
            resample.Update()
            source, image = resample.GetOutputPort(), resample.GetOutput()
        self.mapper.SetInputConnection(source)
        self.mapper.SetBlendMode(original.GetBlendMode())
        self.mapper.SetSampleDistance(
            min(map(abs, image.GetSpacing())) if original.GetLockSampleDistanceToInputSpacing()
            else original.GetSampleDistance())
        return image.GetNumberOfPoints() > 0


_copies: "_weakref.WeakKeyDictionary[object, _Copy]" = _weakref.WeakKeyDictionary()


def _serialize_mapper(parent, mapper, mapper_id, context, depth):
    copy = _copies.get(mapper)
    if copy is None:
        copy = _copies[mapper] = _Copy()
    if mapper.GetNumberOfInputConnections(0) == 0 or not copy.update(parent, mapper):
        _warnings.warn("a deformed volume is left out of the page: only images with scalars of points "
                       "can be resampled for it", stacklevel=2)
        return None
    return _serialize(parent, copy.mapper, mapper_id, context, depth)


_register("vtkFFDInverseRayVolumeMapper", _serialize_mapper)
