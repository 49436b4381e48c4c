# SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
# SPDX-License-Identifier: BSD-3-Clause
"""Deformed volumes in PyVista.

Importing this module adds to PyVista, in its own conventions:

    plotter.add_deformed_volume(grid, lattice, ...)   as add_volume, deformed
    plotter.add_lattice_widget(lattice, actor, ...)   shape the lattice with the mouse
    dataset.ffd.lattice(...) .warp(...) .resample(...) .attach(...) .attached

    import pyvista as pv
    import vtkffd.pyvista

    grid = pv.read("engine.vti")
    lattice = grid.ffd.lattice(6)
    lattice.displacements[3, 3, 3] = (0.0, 40.0, 0.0)
    plotter = pv.Plotter()
    actor = plotter.add_deformed_volume(grid, lattice, cmap="bone", opacity="sigmoid", shade=True)
    plotter.add_lattice_widget(lattice, actor)
    plotter.show()

Lengths are data units, and positions those of the data set at rest, unless something else is said.
Wrong arguments raise TypeError or ValueError.
"""

import functools as _functools
import importlib.util as _importlib_util
import weakref as _weakref

import numpy as _np
import pyvista as _pv
from pyvista.plotting.mapper import _BaseVolumeMapper
from vtkmodules.vtkCommonCore import vtkPoints as _vtkPoints
from vtkmodules.vtkCommonTransforms import vtkAbstractTransform as _vtkAbstractTransform
from vtkmodules.vtkRenderingCore import vtkProp3D as _vtkProp3D

import vtkffd as _vtkffd

__all__ = ["InverseRayVolumeMapper", "Lattice", "add_deformed_volume", "clear_lattice_widgets",
           "lattice_widget"]

_INVERSE_MODES = ("first_order", "exact", "pull_back")
_INTERPOLATIONS = ("nearest", "linear", "cubic")
_SHAPES = ("identity", "bend", "twist", "taper", "bulge", "wave", "random")
_EVENTS = {"start": "StartInteractionEvent", "end": "EndInteractionEvent",
           "always": "InteractionEvent"}


def _choose(name, value, choices):
    """The index of a choice by name, as PyVista's messages say what there is to choose from."""
    if not isinstance(value, str) or value.lower() not in choices:
        raise ValueError(f"{name} {value!r} is unknown; it is one of {', '.join(choices)}")
    return choices.index(value.lower())


def _check_transform(lattice, none_allowed=False):
    if not isinstance(lattice, _vtkAbstractTransform) and not (none_allowed and lattice is None):
        raise TypeError("the lattice must be a vtkffd.pyvista.Lattice, a vtkffd.vtkFFDLattice or "
                        f"another vtkAbstractTransform, not {type(lattice).__name__}")


def _check_number(name, value):
    """A finite number as float."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} {value!r}: a number") from None
    if not _np.isfinite(number):
        raise ValueError(f"{name} {value!r}: a finite number")
    return number


def _check_bounds(bounds):
    """Six floats that are a box of some extent."""
    if isinstance(bounds, tuple):
        bounds = tuple(bounds)  # PyVista's own kind is written in six lines
    try:
        box = _np.asarray(bounds, dtype=float)
        good = box.shape == (6,) and _np.isfinite(box).all() and (box[::2] <= box[1::2]).all()
    except (TypeError, ValueError):
        good = False
    if not good:
        raise ValueError(f"bounds {bounds!r}: (xmin, xmax, ymin, ymax, zmin, zmax), finite")
    if (box[::2] == box[1::2]).all():
        raise ValueError(f"bounds {bounds!r} are a point; some extent along one axis at least")
    return box


class Lattice(_vtkffd.vtkFFDLattice):
    """A vtkFFDLattice whose control points are numpy arrays.

    Parameters
    ----------
    dimensions : int or three, default: 5
        Control points along each axis, at least 4.
    bounds : sequence of six floats, optional
        What the lattice is to deform, (xmin, xmax, ymin, ...), not a point. Default: the unit cube.
    displacements : array_like, optional
        Of the control points; see the property.
    """

    def __init__(self, dimensions=5, bounds=None, displacements=None):
        super().__init__()
        try:
            sizes = _np.broadcast_to(_np.asarray(dimensions), 3)
            good = _np.issubdtype(sizes.dtype, _np.integer) and sizes.min() >= 4
        except ValueError:
            good = False
        if not good:
            raise ValueError(f"dimensions {dimensions!r}: one integer or three, at least 4 control "
                             "points along each axis")
        if sizes.max() <= 1024:
            self.SetDimensions(*(int(size) for size in sizes))
        if self.dimensions != tuple(sizes):
            raise ValueError(f"dimensions {dimensions!r} are too large")
        if bounds is not None:
            box = _check_bounds(bounds)
            self.FitToBounds(box)
            sizes, fitted = box[1::2] - box[::2], _np.diff(self.GetDomain())[::2]
            if not _np.allclose(fitted[sizes > 0.0] / sizes[sizes > 0.0], 1.0):
                raise ValueError(f"bounds {bounds!r} are too large or too small for a lattice")
        if displacements is not None:
            self.displacements = displacements

    @property
    def dimensions(self):
        """Control points along each axis, three integers."""
        return tuple(self.GetDimensions())

    @property
    def rest_points(self):
        """Where the control points are at rest: an array of shape (nx, ny, nz, 3)."""
        bounds = self.GetCoefficientData().GetBounds()
        axes = (_np.linspace(*ends) for ends in zip(bounds[::2], bounds[1::2], self.dimensions))
        return _np.stack(_np.meshgrid(*axes, indexing="ij"), axis=-1)

    @property
    def displacements(self):
        """How far the control points are moved: shape (nx, ny, nz, 3), indexed by i, j, k. It is
        the lattice's own array, so that items can be set, and assigning broadcasts as in numpy; the
        volume follows with the next frame. NaN and infinity are refused by assignment."""
        array = _pv.pyvista_ndarray(self.GetDisplacements())
        return array.reshape((*self.dimensions[::-1], 3)).transpose(2, 1, 0, 3)

    @displacements.setter
    def displacements(self, values):
        values = _np.asarray(values, dtype=float)
        if not _np.isfinite(values).all():
            raise ValueError("displacements must be finite")
        self.displacements[...] = values

    @property
    def points(self):
        """Where the control points are, shape (nx, ny, nz, 3): a copy. Assign to move them, for
        instance lattice.points = lattice.rest_points @ rotation."""
        return self.rest_points + _np.asarray(self.displacements)

    @points.setter
    def points(self, values):
        self.displacements = _np.asarray(values, dtype=float) - self.rest_points

    def apply_shape(self, shape, strength=1.0, seed=1):
        """Replace the displacements by a ready shape, and return the lattice.

        Parameters
        ----------
        shape : str
            "identity", "bend", "twist", "taper", "bulge", "wave" or "random", those of
            vtkFFDLatticeSource.
        strength : float, default: 1.0
            A twist of 1, for instance, is one of 90 degrees in all.
        seed : int, default: 1
            Of "random".
        """
        chosen = _choose("shape", shape, _SHAPES)
        strength = _check_number("strength", strength)
        if not 0 <= seed < 2**31:
            raise ValueError(f"seed {seed!r}: from 0 to 2147483647")
        _vtkffd.vtkFFDLatticeSource.ApplyShape(self, chosen, strength, int(seed))
        return self

    def net(self):
        """The control points as a pyvista.StructuredGrid, for add_mesh(..., style="wireframe"). It
        does not follow later changes."""
        return _pv.StructuredGrid(*_np.moveaxis(self.points, -1, 0))

    def transform(self, points):
        """Where points of the volume at rest are moved: an array of shape (n, 3), or (3,)."""
        given = _np.asarray(points, dtype=float)
        if given.shape[-1:] != (3,) or given.ndim > 2:
            raise ValueError(f"points must be of shape (n, 3) or (3,), not {given.shape}")
        source, moved = _vtkPoints(), _vtkPoints()
        source.SetData(_pv.convert_array(_np.ascontiguousarray(given.reshape(-1, 3))))
        moved.SetDataTypeToDouble()
        self.TransformPoints(source, moved)
        return _np.array(_pv.convert_array(moved.GetData())).reshape(given.shape)


class InverseRayVolumeMapper(_BaseVolumeMapper, _vtkffd.vtkFFDInverseRayVolumeMapper):
    """Wrap vtkFFDInverseRayVolumeMapper as PyVista wraps VTK's volume mappers. What it has no
    property for is set by VTK's methods, SetPositionTolerance() for instance."""

    @property
    def lattice(self):
        """The vtkFFDLattice or other vtkAbstractTransform that deforms the volume, or None for the
        one that is attached to the data set, if any."""
        return self.GetDeformation()

    @lattice.setter
    def lattice(self, lattice):
        _check_transform(lattice, none_allowed=True)
        self.SetDeformation(lattice)

    @property
    def inverse_mode(self):
        """"first_order" (the paper's), "exact" or "pull_back": what the lattice is taken for."""
        return _INVERSE_MODES[self.GetInverseMode()]

    @inverse_mode.setter
    def inverse_mode(self, mode):
        self.SetInverseMode(_choose("inverse_mode", mode, _INVERSE_MODES))


def _with_scalars(volume, scalars, resolution, preference):
    """A shallow copy of the volume on which the scalars are the active ones, at its points, and their
    name."""
    if isinstance(volume, _np.ndarray):
        volume = _pv.wrap(volume)
        volume.spacing = (1.0, 1.0, 1.0) if resolution is None else resolution
    elif isinstance(volume, (_pv.ImageData, _pv.RectilinearGrid)):
        volume = volume.copy(deep=False)
    else:
        raise TypeError("only pyvista.ImageData, pyvista.RectilinearGrid and 3D arrays can be shown "
                        f"deformed, not {type(volume).__name__}; sample it onto an image first "
                        "(pyvista.ImageData.sample)")
    if scalars is None:
        scalars = volume.active_scalars_name
    elif not isinstance(scalars, str):
        volume["Data"] = _np.asarray(scalars)
        scalars = "Data"
    if scalars not in volume.array_names:
        raise _pv.MissingDataError(f"the volume has no scalars {scalars!r}" if scalars
                                   else "the volume has no scalars")
    association, _ = volume.set_active_scalars(scalars, preference=preference)
    # One array of the name: a conversion of cells writes into points.
    at_cells = association == _pv.FieldAssociation.CELL
    other = volume.point_data if at_cells else volume.cell_data
    if scalars in other:
        del other[scalars]
    dtype = (volume.cell_data if at_cells else volume.point_data)[scalars].dtype
    if not _np.issubdtype(dtype, _np.number):
        raise TypeError(f"the scalars {scalars!r} are {dtype}, not numbers; convert them, for instance "
                        "by astype('uint8')")
    if at_cells:
        volume = volume.cell_data_to_point_data()
        volume.set_active_scalars(scalars, preference="point")
    return volume, scalars


@_functools.lru_cache(maxsize=None)
def _prepare_pages():
    """Views that are drawn by a page shall know the mapper, if there can be any."""
    if _importlib_util.find_spec("trame_vtk"):
        try:
            import vtkffd.trame  # noqa: F401
        except ImportError:
            pass  # a version with other modules, or without what it needs


def add_deformed_volume(plotter, volume, lattice=None, *, inverse_mode="exact",
                        position_tolerance=0.1, mapper="inverse_ray", scalars=None,
                        resolution=None, preference="point", clim=None,
                        opacity_unit_distance=None, reset_camera=None, render=True,
                        show_scalar_bar=None, scalar_bar_args=None, **kwargs):
    """Add a volume, deformed by a lattice. It follows the lattice: after a change of that,
    plotter.render() shows it.

    Parameters
    ----------
    plotter : pyvista.Plotter
        Left out where this is called as plotter.add_deformed_volume().
    volume : pyvista.ImageData, pyvista.RectilinearGrid or 3D numpy.ndarray
        The volume at rest. Scalars of cells are taken to the points; they must be numbers, not bool.
    lattice : vtkffd.pyvista.Lattice or vtkAbstractTransform, optional
        Where the material is moved. Default: the lattice that is attached to the volume, if any.
    inverse_mode : str, default: "exact"
        "first_order", "exact" or "pull_back", see vtkFFDInverseRayVolumeMapper.
    position_tolerance : float, default: 0.1
        Voxels that samples may be beside their true positions, above 0.
    mapper : str, default: "inverse_ray"
        How it is drawn. "inverse_ray" bends the viewing rays. The names that add_volume() knows
        ("fixed_point", "gpu", "open_gl", "smart") draw a copy that is resampled now; it does not
        follow the lattice. Only ImageData can be resampled.
    **kwargs
        All other arguments are those of pyvista.Plotter.add_volume(), and mean the same: scalars,
        clim, opacity, cmap, blending, shade, scalar_bar_args ...

    Returns
    -------
    pyvista.Volume
        The actor; actor.mapper is an InverseRayVolumeMapper.
    """
    if lattice is not None:
        _check_transform(lattice)
    _choose("inverse_mode", inverse_mode, _INVERSE_MODES)
    if _check_number("position_tolerance", position_tolerance) <= 0.0:
        raise ValueError(f"position_tolerance {position_tolerance!r}: a positive number of voxels")
    volume, scalars = _with_scalars(volume, scalars, resolution, preference)
    kwargs.update(scalars=scalars, preference="point", clim=kwargs.pop("rng", clim),
                  opacity_unit_distance=opacity_unit_distance)
    if mapper != "inverse_ray":
        if kwargs["clim"] is None:
            kwargs["clim"] = volume.get_data_range(scalars)
        if opacity_unit_distance is None:
            kwargs["opacity_unit_distance"] = volume.length / (_np.mean(volume.dimensions) - 1.0)
        low = -kwargs["clim"] if _np.isscalar(kwargs["clim"]) else kwargs["clim"][0]
        if lattice is None:
            lattice = volume.ffd.attached
        if lattice is not None:
            volume = volume.ffd.resample(lattice, inverse_mode=inverse_mode, background_value=low)
        return plotter.add_volume(
            volume, mapper=mapper, reset_camera=reset_camera, render=render,
            show_scalar_bar=show_scalar_bar, scalar_bar_args=scalar_bar_args, **kwargs)

    _prepare_pages()
    # PyVista makes the actor, its property and its look-up table; then the mapper is replaced. The
    # one that it begins with never draws anything.
    begin = "fixed_point" if isinstance(volume, _pv.ImageData) else "smart"
    actor = plotter.add_volume(volume, mapper=begin, reset_camera=False, render=False,
                               show_scalar_bar=False, **kwargs)
    old, new = actor.mapper, InverseRayVolumeMapper(theme=plotter.theme)
    for name in ("scalar_range", "lookup_table", "scalar_map_mode", "dataset", "blend_mode"):
        setattr(new, name, getattr(old, name))
    new.inverse_mode = inverse_mode
    new.SetPositionTolerance(position_tolerance)
    new.lattice = lattice
    actor.mapper = plotter.mapper = new

    if show_scalar_bar is None:
        show_scalar_bar = plotter.theme.show_scalar_bar or scalar_bar_args
    if show_scalar_bar and volume.active_scalars.ndim == 1:
        plotter.add_scalar_bar(**{"title": scalars, **(scalar_bar_args or {})}, render=False)
    plotter.renderer.update_bounds_axes()
    if reset_camera or (reset_camera is None and not plotter.renderer.camera_set):
        plotter.reset_camera(render=bool(render))
    elif render:
        plotter.render()
    return actor


# The widgets of each plotter, which keeps none itself.
_widgets: "_weakref.WeakKeyDictionary[object, list[_vtkffd.vtkFFDLatticeWidget]]" = (
    _weakref.WeakKeyDictionary())


def _find_rest_bounds(actor):
    """The bounds of the data that is drawn, or None."""
    mapper = actor.GetMapper() if hasattr(actor, "GetMapper") else None
    if mapper is None or mapper.GetNumberOfInputConnections(0) == 0:
        return None
    mapper.GetInputAlgorithm(0, 0).Update()
    data = mapper.GetInputDataObject(0, 0)
    return data.GetBounds() if hasattr(data, "GetBounds") and data.GetNumberOfPoints() > 1 else None


def lattice_widget(plotter, lattice, actor=None, callback=None, *, interaction_event="end",
                   pass_widget=False, bounds=None):
    """Add a vtkFFDLatticeWidget: its control points, and with key d the volume itself, can be
    dragged. Module/Documentation/tutorial.md, "Shape a volume by hand", tells the keys.

    Parameters
    ----------
    plotter : pyvista.Plotter
        Left out where this is called as plotter.add_lattice_widget().
    lattice : vtkffd.pyvista.Lattice or vtkffd.vtkFFDLattice
        The lattice to shape.
    actor : pyvista.Volume or vtkProp3D, optional
        What add_deformed_volume() returned: its matrix is heeded, and it can be taken hold of.
    callback : callable, optional
        Called with the lattice, and with the widget as well if pass_widget is true.
    interaction_event : str, default: "end"
        When: at the "start" or "end" of an edit, or "always".
    pass_widget : bool, default: False
        Whether the callback takes the widget, too.
    bounds : sequence of six floats, optional
        The box of the outline, finite. Default: the bounds of the volume of actor at rest.

    Returns
    -------
    vtkffd.vtkFFDLatticeWidget
        The widget. Options are those of widget.GetLatticeRepresentation().
    """
    if not isinstance(lattice, _vtkffd.vtkFFDLattice):
        raise TypeError(f"the lattice must be a vtkffd.vtkFFDLattice, not {type(lattice).__name__}")
    if actor is not None and not isinstance(actor, _vtkProp3D):
        raise TypeError("the actor must be the pyvista.Volume that add_deformed_volume() returned, or "
                        f"another vtkProp3D, not {type(actor).__name__}")
    if bounds is None and actor is not None:
        bounds = _find_rest_bounds(actor)
    if bounds is not None:
        bounds = _check_bounds(bounds)
    if callback is not None and not callable(callback):
        raise TypeError("callback must be callable")
    event = list(_EVENTS.values())[_choose("interaction_event", interaction_event, list(_EVENTS))]
    if plotter.iren is None:
        raise RuntimeError("the plotter has no interactor any more: it is closed")
    widget = _vtkffd.vtkFFDLatticeWidget()
    representation = widget.GetLatticeRepresentation()
    representation.SetLattice(lattice)
    if actor is not None:
        representation.SetProp(actor)
        picker = _vtkffd.vtkFFDVolumePicker()
        picker.PickFromListOn()
        picker.AddPickList(actor)
        representation.SetSurfacePicker(picker)
    if bounds is not None:
        representation.SetOutlineBounds(bounds)
    widget.SetInteractor(plotter.iren.interactor)
    widget.SetDefaultRenderer(plotter.renderer)
    widget.SetCurrentRenderer(plotter.renderer)
    widget.KeyPressActivationOff()
    if callback is not None:
        arguments = (lattice, widget) if pass_widget else (lattice,)
        widget.AddObserver(event, lambda *_: callback(*arguments))
    widget.On()
    _widgets.setdefault(plotter, []).append(widget)
    return widget


def clear_lattice_widgets(plotter):
    """Remove all lattice widgets of the plotter."""
    for widget in _widgets.pop(plotter, []):
        widget.Off()


class _Accessor:
    """Lattices for a data set, and what they do to it."""

    def __init__(self, dataset):
        self._dataset = dataset

    def lattice(self, dimensions=5, shape=None, strength=1.0, displacements=None):
        """A Lattice around the data set.

        Parameters
        ----------
        dimensions : int or three, default: 5
            Control points along each axis, at least 4.
        shape : str, optional
            See Lattice.apply_shape(), as for strength. Default: at rest.
        strength : float, default: 1.0
            Of the shape.
        displacements : array_like, optional
            Of the control points, (nx, ny, nz, 3), instead of a shape.
        """
        if shape is not None and displacements is not None:
            raise ValueError("give a shape or displacements, not both")
        lattice = Lattice(dimensions, self._dataset.bounds, displacements)
        return lattice if shape is None else lattice.apply_shape(shape, strength)

    def warp(self, lattice, inverse_mode="exact"):
        """The data set, moved as the volume is: points, and the normals and vectors on them
        (vtkFFDDeformGeometry). A new data set; images and rectilinear grids become structured
        grids.

        Parameters
        ----------
        lattice : vtkffd.pyvista.Lattice or vtkAbstractTransform
            The deformation.
        inverse_mode : str, default: "exact"
            That of the volume, see add_deformed_volume().
        """
        _check_transform(lattice)
        dataset = self._dataset
        if isinstance(dataset, (_pv.ImageData, _pv.RectilinearGrid)):
            dataset = dataset.cast_to_structured_grid()
        warp = _vtkffd.vtkFFDDeformGeometry()
        warp.SetInputData(dataset)
        warp.SetDeformation(lattice)
        warp.SetInverseMode(_choose("inverse_mode", inverse_mode, _INVERSE_MODES))
        warp.Update()
        return _pv.wrap(warp.GetOutput())

    def resample(self, lattice=None, spacing=None, interpolation="linear", inverse_mode="exact",
                 background_value=0.0):
        """The deformed volume as a pyvista.ImageData of its own, for other programs
        (vtkFFDResampleVolume). It spans the bounds of the deformed volume.

        Parameters
        ----------
        lattice : vtkffd.pyvista.Lattice or vtkAbstractTransform, optional
            The deformation. Default: the attached lattice.
        spacing : sequence of three floats, optional
            Of the new image. Default: that of this one.
        interpolation : str, default: "linear"
            "nearest", "linear" or "cubic".
        inverse_mode : str, default: "exact"
            "first_order", "exact" or "pull_back".
        background_value : float, default: 0.0
            Of voxels that no material has moved to, finite.
        """
        if not isinstance(self._dataset, _pv.ImageData):
            raise TypeError("only pyvista.ImageData can be resampled, not "
                            f"{type(self._dataset).__name__}; warp() moves the points of others")
        _check_transform(lattice, none_allowed=True)
        resample = _vtkffd.vtkFFDResampleVolume()
        resample.SetInputData(self._dataset)
        resample.SetDeformation(lattice)
        resample.SetInterpolationMode(_choose("interpolation", interpolation, _INTERPOLATIONS))
        resample.SetInverseMode(_choose("inverse_mode", inverse_mode, _INVERSE_MODES))
        resample.SetBackgroundLevel(_check_number("background_value", background_value))
        if spacing is not None:
            if (_np.shape(spacing) != (3,) or not _np.greater(spacing, 0.0).all()
                    or not _np.isfinite(spacing).all()):
                raise ValueError(f"spacing {spacing!r}: three positive numbers, finite")
            resample.SetOutputSpacing(*spacing)
        resample.Update()
        if resample.GetOutput().GetNumberOfPoints() == 0:
            raise ValueError("the volume cannot be resampled; VTK's messages say why")
        return _pv.wrap(resample.GetOutput())

    def attach(self, lattice):
        """Let the data set carry the lattice, through copies and files; None takes it away."""
        if lattice is None:
            _vtkffd.vtkFFDLattice.DetachFrom(self._dataset)
        elif isinstance(lattice, _vtkffd.vtkFFDLattice):
            lattice.AttachTo(self._dataset)
        else:
            raise TypeError(f"only a lattice can be attached, not {type(lattice).__name__}")

    @property
    def attached(self):
        """A copy of the attached lattice, or None."""
        lattice = Lattice()
        if _vtkffd.vtkFFDLattice.HasLattice(self._dataset) and lattice.ReadFrom(self._dataset):
            return lattice
        return None


if hasattr(_pv, "register_dataset_accessor"):  # since PyVista 0.48
    _pv.register_dataset_accessor("ffd", _pv.DataSet)(_Accessor)
else:
    _pv.DataSet.ffd = property(_Accessor, doc=_Accessor.__doc__)
_pv.BasePlotter.add_deformed_volume = add_deformed_volume
_pv.BasePlotter.add_lattice_widget = lattice_widget
_pv.BasePlotter.clear_lattice_widgets = clear_lattice_widgets
