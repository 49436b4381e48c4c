// SPDX-FileCopyrightText: Copyright (c) vtkFFD authors
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSMFFDVolumeRepresentationProxy
 * @brief   the client's side of the representation "FFD Volume"
 *
 * ParaView picks an array to color by when a volume is chosen as representation, but only for its
 * own types: another one would stay blank for a data set in solid color. This proxy does the same
 * for "FFD Volume": when the representation that it is a part of is switched to it, and no array
 * is chosen, it picks the first point array, or else the first cell array. Shading, blend mode,
 * opacity unit distance, isosurfaces and cropping, which "Volume" has as properties of its own, are
 * handed from the one to the other when they change, so that a switch between them keeps them. It
 * asks the server for coarse pictures. And it warns where data with a lattice are shown by a
 * representation that shows them at rest.
 */
#ifndef vtkSMFFDVolumeRepresentationProxy_h
#define vtkSMFFDVolumeRepresentationProxy_h

#include "vtkFFDParaViewModule.h" // For export macro
#include "vtkSMRepresentationProxy.h"

#include <string> // for std::string

class vtkSMRenderViewProxy;
class vtkSMSession;

class VTKFFDPARAVIEW_EXPORT vtkSMFFDVolumeRepresentationProxy : public vtkSMRepresentationProxy
{
public:
  static vtkSMFFDVolumeRepresentationProxy* New();
  vtkTypeMacro(vtkSMFFDVolumeRepresentationProxy, vtkSMRepresentationProxy);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Let the server make its next picture with the quality of moving ones, of `rate` pictures a
   * second, even if it is asked for as a still one. False, and nothing is done, where this
   * representation is not shown, or moving pictures are as still ones.
   */
  bool RenderNextAtRate(double rate);

  /**
   * vtkFFDVolumeRepresentation::Pick() where the volume is rendered. False if nothing is seen on
   * the line between the two places, world coordinates, or this representation is not shown.
   * `shown` is the place, world coordinates, and `rest` its place in the data. The information
   * property FFDPicked has the result, too.
   */
  bool Pick(
    const double from[3], const double to[3], double shown[3], double rest[3], double& value);

  /// The array that is shown, "" if there is none.
  std::string GetShownArray();

  /**
   * What a pixel of a view (from the lower left corner) shows of a surface of a volume with a
   * lattice, a slice for instance: its place in the scene, that at rest, and the name and value of
   * the array that it is colored by (the name is empty if it is not). False if it shows something
   * else.
   */
  static bool PickSurface(vtkSMRenderViewProxy* view, const int pixel[2], double shown[3],
    double rest[3], std::string& array, double& value);

  /**
   * The type of a representation if it is one of those that show data with a lattice at rest, and
   * its data have one; "lattice dropped" if they have none and are made of data with one; else "".
   */
  static std::string FindTypeAtRest(vtkSMProxy* representation);

  /// What is shown where FindTypeAtRest() returned that, and what to do about it.
  static std::string ExplainRest(const std::string& type);

  /// Whether a warning says that, which is on by default; off where an application has other means.
  static void SetWarnsOfRest(bool warns);

  /**
   * Says, once for each session, if its server has not the plugin, or another version of it than
   * the client: what the one asks for, the other may not know.
   */
  static void CheckServer(vtkSMSession* session);

protected:
  vtkSMFFDVolumeRepresentationProxy();
  ~vtkSMFFDVolumeRepresentationProxy() override;

  void CreateVTKObjects() override;

private:
  vtkSMFFDVolumeRepresentationProxy(const vtkSMFFDVolumeRepresentationProxy&) = delete;
  void operator=(const vtkSMFFDVolumeRepresentationProxy&) = delete;

  bool IsVisible();
  void FollowOlder();
  void PickArray();
  void WarnOfRest();
  void Mirror(vtkObject* option, unsigned long event, void* data);

  bool Watching = false;
  bool Picking = false;
  bool Mirroring = false;
  std::string WarnedOf; // the representation that was last warned of
};

#endif
